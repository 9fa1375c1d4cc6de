#include "harness/mujoco/guard.h"

#include <thread>

#include <gtest/gtest.h>

#include "harness/mujoco/model.h"

namespace quayside::harness::mujoco {
namespace {

constexpr char kPoint[] =
    "<mujoco><worldbody><body><freejoint/><inertial pos='0 0 0' mass='2' diaginertia='1 1 1'/></body></worldbody>"
    "</mujoco>";

TEST(Guard, ErrorsAndWarningsBecomeExceptionsWithTheirWords) {
  const ProcessHooks hooks;
  try {
    guarded([] { mju_error("a broken model"); });
    FAIL();
  } catch (const MujocoError& e) {
    EXPECT_STREQ(e.what(), "a broken model");
  }
  EXPECT_THROW(guarded([] { mju_warning("a doubtful model"); }), MujocoError);
  EXPECT_NO_THROW(guarded([] {}));
}

TEST(Guard, TheHandlersBeforeUsReturn) {
  const auto mine = [](const char*) {};
  mju_user_warning = mine;
  mjcb_passive = nullptr;
  {
    const ProcessHooks first;
    {
      const ProcessHooks second;
    }
    EXPECT_NE(mju_user_warning, static_cast<void (*)(const char*)>(mine));
    EXPECT_NE(mjcb_passive, nullptr);
  }
  EXPECT_EQ(mju_user_warning, static_cast<void (*)(const char*)>(mine));
  EXPECT_EQ(mjcb_passive, nullptr);
  mju_user_warning = nullptr;
}

class Push final : public PassiveLaw {
 public:
  explicit Push(double force) : force_(force) {}
  void add_passive_forces(const mjModel*, mjData* data) override {
    if (force_ == 0) throw std::runtime_error("no force");
    data->qfrc_passive[0] += force_;
  }

 private:
  double force_;
};

// Two models, two laws, two threads at the same time: each gets the acceleration F/m of its own force and no other.
TEST(Guard, LawsActOnTheirOwnDataAlone) {
  const ProcessHooks hooks;
  const auto accelerate = [](double force, double& worst) {
    const ModelPointer model = compile(kPoint);
    const DataPointer data(mj_makeData(model.get()));
    Push push(force);
    for (int i = 0; i < 2000; ++i) {
      guarded(&push, data.get(), [&] { mj_forward(model.get(), data.get()); });
      worst = std::max(worst, std::abs(data->qacc[0] - force / 2));
    }
    guarded([&] { mj_forward(model.get(), data.get()); });
    worst = std::max(worst, std::abs(data->qacc[0]));
  };
  double worst[2] = {0, 0};
  std::thread other([&] { accelerate(7, worst[0]); });
  accelerate(-3, worst[1]);
  other.join();
  EXPECT_EQ(worst[0], 0);
  EXPECT_EQ(worst[1], 0);
}

TEST(Guard, WhatTheLawThrowsArrives) {
  const ProcessHooks hooks;
  const ModelPointer model = compile(kPoint);
  const DataPointer data(mj_makeData(model.get()));
  Push push(0);
  EXPECT_THROW(guarded(&push, data.get(), [&] { mj_forward(model.get(), data.get()); }), std::runtime_error);
}

}  // namespace
}  // namespace quayside::harness::mujoco
