#include "harness/simbody/cvodes_integrator.h"

#include <algorithm>
#include <cassert>

#include <cvodes/cvodes.h>
#include <cvodes/cvodes_proj.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "harness/simbody/sundials.h"

namespace quayside::harness {
namespace {

using namespace sundials;

void free_solver(void* memory) { CVodeFree(&memory); }
void free_nonlinear_solver(SUNNonlinearSolver s) { SUNNonlinSolFree(s); }

class CvodesIntegrator final : public Integrator {
 public:
  CvodesIntegrator(CvodesMethod method, OdeSystem& system, const IntegratorSettings& settings);

  void restart(double t, const double* y, const double* z, int max_order) override;
  void watch_stability(bool watch) override;
  bool renew_jacobian() override { return renew_ = method_ == CvodesMethod::bdf; }
  double step(double stop) override;
  double time() const override { return time_; }
  double step_begin() const override { return step_begin_; }
  void interpolate(double t, double* y, double* z) const override;
  std::uint64_t steps() const override { return steps_ + count(CVodeGetNumSteps); }
  std::uint64_t jacobians() const override { return jacobians_ + count(CVodeGetNumJacEvals); }

 private:
  void set_jacobian_ages(long steps);
  std::uint64_t count(int (*counter)(void*, long*)) const {
    long value = 0;
    if (started_) counter(cvodes_, &value);
    return static_cast<std::uint64_t>(value);
  }

  const CvodesMethod method_;
  Callbacks callbacks_;
  bool renew_ = false;                       // the Jacobian, in the next step
  bool started_ = false;                      // restarted at least once
  std::uint64_t steps_ = 0, jacobians_ = 0;  // before the last restart
  double step_begin_ = 0, time_ = 0;

  // In this order, so that they are released in the opposite one.
  Context context_;
  Vector y_, tolerances_, z_, y_scratch_, z_scratch_;
  Matrix matrix_;
  BlockLu lu_;
  LinearSolver linear_solver_;
  Owner<SUNNonlinearSolver, free_nonlinear_solver> nonlinear_solver_;
  Owner<void*, free_solver> cvodes_;
};

CvodesIntegrator::CvodesIntegrator(CvodesMethod method, OdeSystem& system, const IntegratorSettings& settings)
    : method_(method), callbacks_(system), lu_(static_cast<int>(settings.tolerances.size()), settings.blocks) {
  const auto demand = [&](int flag, const char* what) { callbacks_.demand(flag, what); };
  const auto n = static_cast<sunindextype>(settings.tolerances.size());
  demand(SUNContext_Create(nullptr, &context_.value), "SUNContext_Create");
  for (auto* vector : {&y_, &tolerances_, &y_scratch_}) vector->value = N_VNew_Serial(n, context_);
  for (auto* vector : {&z_, &z_scratch_}) vector->value = N_VNew_Serial(settings.quadratures, context_);
  std::copy(settings.tolerances.begin(), settings.tolerances.end(), data(tolerances_));
  N_VConst(0, y_);
  N_VConst(0, z_);

  cvodes_.value = CVodeCreate(method == CvodesMethod::bdf ? CV_BDF : CV_ADAMS, context_);
  demand(CVodeSetErrHandlerFn(cvodes_, Callbacks::note_error, &callbacks_), "CVodeSetErrHandlerFn");
  demand(CVodeInit(cvodes_, Callbacks::derivative, 0, y_), "CVodeInit");
  demand(CVodeSetUserData(cvodes_, &callbacks_), "CVodeSetUserData");
  demand(CVodeSVtolerances(cvodes_, 0, tolerances_), "CVodeSVtolerances");
  if (method == CvodesMethod::bdf) {
    matrix_.value = SUNDenseMatrix(n, n, context_);
    linear_solver_.value = new_block_solver(lu_, context_);
    demand(CVodeSetLinearSolver(cvodes_, linear_solver_, matrix_), "CVodeSetLinearSolver");
    demand(CVodeSetJacFn(cvodes_, Callbacks::jacobian), "CVodeSetJacFn");
    demand(CVodeSetProjFn(cvodes_, Callbacks::project), "CVodeSetProjFn");  // which CVODES has for BDF alone
  } else {
    nonlinear_solver_.value = SUNNonlinSol_FixedPoint(y_, 0, context_);
    demand(CVodeSetNonlinearSolver(cvodes_, nonlinear_solver_), "CVodeSetNonlinearSolver");
  }
  demand(CVodeQuadInit(cvodes_, Callbacks::quadrature, z_), "CVodeQuadInit");
  demand(CVodeSetMaxErrTestFails(cvodes_, kMaxErrorTestFailures), "CVodeSetMaxErrTestFails");
  demand(CVodeSetMaxConvFails(cvodes_, kMaxConvergenceFailures), "CVodeSetMaxConvFails");
  demand(CVodeSetMinStep(cvodes_, kShortestStep), "CVodeSetMinStep");
  if (settings.max_step > 0) demand(CVodeSetMaxStep(cvodes_, settings.max_step), "CVodeSetMaxStep");
}

void CvodesIntegrator::restart(double t, const double* y, const double* z, int max_order) {
  assert(max_order >= 1 && max_order <= kHighestOrder);
  steps_ = steps();
  jacobians_ = jacobians();
  std::copy_n(y, N_VGetLength(y_), data(y_));
  std::copy_n(z, N_VGetLength(z_), data(z_));
  if (method_ == CvodesMethod::bdf) callbacks_.demand(CVodeSetMaxOrd(cvodes_, max_order), "CVodeSetMaxOrd");
  callbacks_.demand(CVodeReInit(cvodes_, t, y_), "CVodeReInit");
  callbacks_.demand(CVodeQuadReInit(cvodes_, z_), "CVodeQuadReInit");
  step_begin_ = time_ = t;
  renew_ = false;
  started_ = true;
}

void CvodesIntegrator::watch_stability(bool watch) {
  if (method_ == CvodesMethod::bdf) callbacks_.demand(CVodeSetStabLimDet(cvodes_, watch), "CVodeSetStabLimDet");
}

// After how many steps Newton's matrix and the Jacobian in it are made anew at the latest; 0: the library's own.
void CvodesIntegrator::set_jacobian_ages(long steps) {
  if (method_ != CvodesMethod::bdf) return;  // which has none
  callbacks_.demand(CVodeSetLSetupFrequency(cvodes_, steps), "CVodeSetLSetupFrequency");
  callbacks_.demand(CVodeSetJacEvalFrequency(cvodes_, steps), "CVodeSetJacEvalFrequency");
}

double CvodesIntegrator::step(double stop) {
  assert(stop > time_);
  callbacks_.demand(CVodeSetStopTime(cvodes_, stop), "CVodeSetStopTime");
  double reached = time_;
  set_jacobian_ages(renew_ ? 1 : 0);
  const int flag = CVode(cvodes_, time_ + kOutlook, y_, &reached, CV_ONE_STEP);
  renew_ = false;
  callbacks_.rethrow();
  if (flag < 0) throw IntegrationFailed(reason(flag, "CVODES", callbacks_.message()));
  step_begin_ = time_;
  time_ = reached;
  return reached;
}

void CvodesIntegrator::interpolate(double t, double* y, double* z) const {
  assert(t >= step_begin_ && t <= time_);
  N_Vector y_then = y_, z_then = z_;
  if (step_begin_ < time_) {  // else nothing is integrated since the restart
    y_then = y_scratch_;
    z_then = z_scratch_;
    callbacks_.demand(CVodeGetDky(cvodes_, t, 0, y_then), "CVodeGetDky");
    callbacks_.demand(CVodeGetQuadDky(cvodes_, t, 0, z_then), "CVodeGetQuadDky");
  }
  std::copy_n(data(y_then), N_VGetLength(y_then), y);
  std::copy_n(data(z_then), N_VGetLength(z_then), z);
}

}  // namespace

std::unique_ptr<Integrator> make_cvodes_integrator(CvodesMethod method, OdeSystem& system,
                                                   const IntegratorSettings& settings) {
  return std::make_unique<CvodesIntegrator>(method, system, settings);
}

}  // namespace quayside::harness
