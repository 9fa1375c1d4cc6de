#include "harness/terminal.h"

#include <gtest/gtest.h>

namespace quayside::harness {
namespace {

TEST(Table, AlignsByCharactersNotByBytes) {
  Table table({Table::Align::left, Table::Align::right});
  table.add({"✓ ±", "1"});
  table.add({"abcd", "100"});
  EXPECT_EQ(table.text(" "), " ✓ ±     1\n abcd  100\n");
}

TEST(Table, ColoursTakeNoRoom) {
  const Style style{true};
  EXPECT_EQ(display_width(style.bad("✗ x")), 3u);
  Table table({Table::Align::right});
  table.add({style.good("1")});
  table.add({"10"});
  EXPECT_EQ(table.text(""), " \033[32m1\033[0m\n10\n");
}

TEST(Table, EmptyCellsAndColumnsLeaveNoTrace) {
  Table table({Table::Align::left, Table::Align::left, Table::Align::left});
  table.add({"a", "", "b"});
  table.add({"c"});
  EXPECT_EQ(table.text(""), "a  b\nc\n");
}

TEST(Style, WithoutColoursTextStaysAsItIs) { EXPECT_EQ(Style{}.bad("x"), "x"); }

TEST(Format, Numbers) {
  EXPECT_EQ(format_number(5.182), "5.182");
  EXPECT_EQ(format_number(1.23456e-7, 3), "1.23e-07");
  EXPECT_EQ(format_quantity(2, "m"), "2 m");
  EXPECT_EQ(format_quantity(2, "1"), "2");
}

TEST(Format, Durations) {
  EXPECT_EQ(format_duration(0.42), "0.4 s");
  EXPECT_EQ(format_duration(9.99), "10 s");
  EXPECT_EQ(format_duration(59.6), "1 min 0 s");
  EXPECT_EQ(format_duration(200), "3 min 20 s");
  EXPECT_EQ(format_duration(7500), "2 h 5 min");
}

// A quarter done in 10 s leaves 30 s.
TEST(ProgressLine, TellsPartAndTimeLeft) {
  EXPECT_EQ(progress_line("case", 0.25, 10, 80), "case  [#######-----------------------]  25 %  30 s left");
}

TEST(ProgressLine, GivesNoTimeBeforeItKnows) {
  EXPECT_EQ(progress_line("case", 0.001, 1, 80).find("left"), std::string::npos);
}

TEST(ProgressLine, IsCutBetweenCharacters) {
  EXPECT_EQ(progress_line("Größe", 0.5, 1, 3), "Grö");
  EXPECT_EQ(display_width(progress_line("case", 2, 1, 20)), 20u);
}

}  // namespace
}  // namespace quayside::harness
