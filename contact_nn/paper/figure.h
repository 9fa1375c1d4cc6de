// The paper's figures 5 and 6: what a network says to part of the external set, as dots, beside what it should say, as
// a line.
#pragma once

#include <string>
#include <vector>

namespace quayside::contact_nn::paper {

// One self-contained SVG document. Throws std::invalid_argument unless there are as many dots as points of the line,
// and at least two.
std::string prediction_svg(const std::string& title, const std::string& y_title, const std::vector<double>& desired,
                           const std::vector<double>& predicted);

}  // namespace quayside::contact_nn::paper
