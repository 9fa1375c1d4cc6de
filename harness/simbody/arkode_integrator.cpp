#include "harness/simbody/arkode_integrator.h"

#include <algorithm>
#include <cassert>

#include <arkode/arkode_arkstep.h>

#include "harness/simbody/step_quadrature.h"
#include "harness/simbody/sundials.h"

namespace quayside::harness {
namespace {

using namespace sundials;

void free_solver(void* memory) { ARKStepFree(&memory); }

// The library's dense output is the cubic p₃ through both ends of a step, which costs nothing. A quartic, as order five is worth,
// has one more condition, its slope here (as a part of the step, where s² (1 − s)² has its steepest one): one evaluation a step.
// The library's own quartic would ask for it anew at every look.
constexpr int kCubic = 3;
constexpr double kRefinedAt = 0.2113248654051871;  // ½ − √3/6

// Stages that are not finite end the library's step for good: it is begun anew, this much shorter each time.
constexpr double kShorter = 0.1;

class ArkodeIntegrator final : public Integrator {
 public:
  ArkodeIntegrator(ArkodeMethod method, OdeSystem& system, const IntegratorSettings& settings);

  void restart(double t, const double* y, const double* z, int max_order) override;
  double step(double stop) override;
  double time() const override { return time_; }
  double step_begin() const override { return step_begin_; }
  void interpolate(double t, double* y, double* z) const override;
  std::uint64_t steps() const override { return steps_ + count(ARKStepGetNumSteps); }
  std::uint64_t jacobians() const override { return jacobians_ + count(ARKStepGetNumJacEvals); }

 private:
  std::uint64_t count(int (*counter)(void*, long*)) const {
    long value = 0;
    if (started_) counter(arkode_, &value);
    return static_cast<std::uint64_t>(value);
  }
  static int normalize(realtype, N_Vector y, void* self) {
    auto& integrator = *static_cast<ArkodeIntegrator*>(self);
    const int flag = Callbacks::project(0, y, integrator.correction_, 0, nullptr, &integrator.callbacks_);
    if (flag == 0) N_VLinearSum(1, y, 1, integrator.correction_, y);
    return flag;
  }
  static int derivative(realtype t, N_Vector y, N_Vector y_dot, void* self) {
    return Callbacks::derivative(t, y, y_dot, &static_cast<ArkodeIntegrator*>(self)->callbacks_);
  }
  static int jacobian(realtype t, N_Vector y, N_Vector y_dot, SUNMatrix matrix, void* self, N_Vector a, N_Vector b,
                      N_Vector c) {
    return Callbacks::jacobian(t, y, y_dot, matrix, &static_cast<ArkodeIntegrator*>(self)->callbacks_, a, b, c);
  }

  void begin(double first_step);
  void dense_output(double t, N_Vector y) const;
  void refine_dense_output();

  const ArkodeMethod method_;
  Callbacks callbacks_;
  StepQuadrature quadrature_;
  bool started_ = false;                      // restarted at least once
  std::uint64_t steps_ = 0, jacobians_ = 0;  // before the last restart
  double step_begin_ = 0, time_ = 0;

  // In this order, so that they are released in the opposite one.
  Context context_;
  Vector y_, tolerances_, y_scratch_, correction_;
  Vector quartic_;  // times s² (1 − s)² more than the cubic; 0 for methods of order four
  Matrix matrix_;
  BlockLu lu_;
  LinearSolver linear_solver_;
  Owner<void*, free_solver> arkode_;
};

ArkodeIntegrator::ArkodeIntegrator(ArkodeMethod method, OdeSystem& system, const IntegratorSettings& settings)
    : method_(method), callbacks_(system), quadrature_(system, settings.quadratures),
      lu_(static_cast<int>(settings.tolerances.size()), settings.blocks) {
  const auto demand = [&](int flag, const char* what) { callbacks_.demand(flag, what); };
  const auto n = static_cast<sunindextype>(settings.tolerances.size());
  demand(SUNContext_Create(nullptr, &context_.value), "SUNContext_Create");
  for (auto* vector : {&y_, &tolerances_, &y_scratch_, &correction_, &quartic_}) vector->value = N_VNew_Serial(n, context_);
  std::copy(settings.tolerances.begin(), settings.tolerances.end(), data(tolerances_));
  N_VConst(0, y_);
  N_VConst(0, quartic_);

  const bool is_explicit = method == ArkodeMethod::explicit_runge_kutta;
  arkode_.value = ARKStepCreate(is_explicit ? derivative : nullptr, is_explicit ? nullptr : derivative, 0, y_, context_);
  demand(ARKStepSetErrHandlerFn(arkode_, Callbacks::note_error, &callbacks_), "ARKStepSetErrHandlerFn");
  demand(ARKStepSetUserData(arkode_, this), "ARKStepSetUserData");
  demand(ARKStepSVtolerances(arkode_, 0, tolerances_), "ARKStepSVtolerances");
  if (is_explicit) {
    demand(ARKStepSetTableNum(arkode_, ARKODE_DIRK_NONE, ARKODE_DORMAND_PRINCE_7_4_5), "ARKStepSetTableNum");
  } else {
    demand(ARKStepSetTableNum(arkode_, ARKODE_SDIRK_5_3_4, ARKODE_ERK_NONE), "ARKStepSetTableNum");
    matrix_.value = SUNDenseMatrix(n, n, context_);
    linear_solver_.value = new_block_solver(lu_, context_);
    demand(ARKStepSetLinearSolver(arkode_, linear_solver_, matrix_), "ARKStepSetLinearSolver");
    demand(ARKStepSetJacFn(arkode_, jacobian), "ARKStepSetJacFn");
  }
  demand(ARKStepSetInterpolantDegree(arkode_, kCubic), "ARKStepSetInterpolantDegree");
  demand(ARKStepSetPostprocessStepFn(arkode_, normalize), "ARKStepSetPostprocessStepFn");
  demand(ARKStepSetMaxErrTestFails(arkode_, kMaxErrorTestFailures), "ARKStepSetMaxErrTestFails");
  demand(ARKStepSetMaxConvFails(arkode_, kMaxConvergenceFailures), "ARKStepSetMaxConvFails");
  demand(ARKStepSetMinStep(arkode_, kShortestStep), "ARKStepSetMinStep");
  if (settings.max_step > 0) demand(ARKStepSetMaxStep(arkode_, settings.max_step), "ARKStepSetMaxStep");
}

void ArkodeIntegrator::restart(double t, const double* y, const double* z, int) {
  std::copy_n(y, N_VGetLength(y_), data(y_));
  quadrature_.restart(t, y, z);
  step_begin_ = time_ = t;
  begin(0);
  started_ = true;
}

// From `time_` and `y_`; `first_step` 0: as the library chooses it.
void ArkodeIntegrator::begin(double first_step) {
  steps_ = steps();
  jacobians_ = jacobians();
  const bool is_explicit = method_ == ArkodeMethod::explicit_runge_kutta;
  callbacks_.demand(
      ARKStepReInit(arkode_, is_explicit ? derivative : nullptr, is_explicit ? nullptr : derivative, time_, y_),
      "ARKStepReInit");
  callbacks_.demand(ARKStepSetInitStep(arkode_, first_step), "ARKStepSetInitStep");
}

double ArkodeIntegrator::step(double stop) {
  assert(stop > time_);
  callbacks_.demand(ARKStepSetStopTime(arkode_, stop), "ARKStepSetStopTime");
  double reached = time_;
  const auto evolve = [&] { return ARKStepEvolve(arkode_, time_ + kOutlook, y_scratch_, &reached, ARK_ONE_STEP); };
  int flag = evolve();
  double tried = stop - time_;
  while (flag <= ARK_RHSFUNC_FAIL && flag >= ARK_UNREC_RHSFUNC_ERR && !callbacks_.threw() && tried > kShortestStep) {
    ARKStepGetCurrentStep(arkode_, &tried);
    tried *= kShorter;
    begin(tried);
    callbacks_.demand(ARKStepSetStopTime(arkode_, stop), "ARKStepSetStopTime");
    flag = evolve();
  }
  if (flag < 0) step_begin_ = time_;  // a step that failed leaves ARKODE without dense output
  callbacks_.rethrow();
  if (flag < 0) throw IntegrationFailed(reason(flag, "ARKODE", callbacks_.message()));
  N_VScale(1, y_scratch_, y_);
  step_begin_ = time_;
  time_ = reached;
  if (method_ == ArkodeMethod::explicit_runge_kutta) refine_dense_output();
  dense_output(0.5 * (step_begin_ + time_), y_scratch_);
  quadrature_.advance(time_, data(y_scratch_), data(y_));
  return reached;
}

// What p₃ lacks of f(t, p₃) in slope at one point makes it a quartic.
void ArkodeIntegrator::refine_dense_output() {
  const double h = time_ - step_begin_, s = kRefinedAt, t = step_begin_ + s * h;
  callbacks_.demand(ARKStepGetDky(arkode_, t, 0, y_scratch_), "ARKStepGetDky");
  callbacks_.demand(ARKStepGetDky(arkode_, t, 1, correction_), "ARKStepGetDky");
  if (Callbacks::derivative(t, y_scratch_, quartic_, &callbacks_) != 0) {  // not finite there: the cubic has to do
    callbacks_.rethrow();
    N_VConst(0, quartic_);
    return;
  }
  N_VLinearSum(1, quartic_, -1, correction_, quartic_);
  N_VScale(h / (2 * s * (1 - s) * (1 - 2 * s)), quartic_, quartic_);
}

void ArkodeIntegrator::dense_output(double t, N_Vector y) const {
  callbacks_.demand(ARKStepGetDky(arkode_, t, 0, y), "ARKStepGetDky");
  const double s = (t - step_begin_) / (time_ - step_begin_);
  N_VLinearSum(1, y, s * s * (1 - s) * (1 - s), quartic_, y);
}

void ArkodeIntegrator::interpolate(double t, double* y, double* z) const {
  assert(t >= step_begin_ && t <= time_);
  N_Vector y_then = y_;
  if (t < time_) {
    y_then = y_scratch_;
    dense_output(t, y_then);
  }
  std::copy_n(data(y_then), N_VGetLength(y_then), y);
  quadrature_.interpolate(t, z);
}

}  // namespace

std::unique_ptr<Integrator> make_arkode_integrator(ArkodeMethod method, OdeSystem& system,
                                                   const IntegratorSettings& settings) {
  return std::make_unique<ArkodeIntegrator>(method, system, settings);
}

}  // namespace quayside::harness
