#include "harness/simbody/bdf_integrator.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <exception>
#include <utility>

#include <cvodes/cvodes.h>
#include <cvodes/cvodes_proj.h>
#include <fmt/format.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

namespace quayside::harness {
namespace {

// The first step's bound is a fraction of the distance to the "next output", which one-step mode has none of.
constexpr double kOutlook = 1.0;  // [s]

// An impact can follow a long smooth flight: more halvings than the library's default (7) lie between their steps.
constexpr int kMaxErrorTestFailures = 30;
constexpr int kMaxConvergenceFailures = 30;

// Steps below this get nowhere: time itself is known to 1e-12 s after an hour [s].
constexpr double kShortestStep = 1e-11;

constexpr int kHighestOrder = 5;

template <typename T, void (*release)(T)>
struct Owner {
  T value{};
  ~Owner() {
    if (value) release(value);
  }
  operator T() const { return value; }
};
void free_vector(N_Vector v) { N_VDestroy(v); }
void free_matrix(SUNMatrix m) { SUNMatDestroy(m); }
void free_linear_solver(SUNLinearSolver s) { SUNLinSolFree(s); }
void free_solver(void* memory) { CVodeFree(&memory); }
void free_context(SUNContext context) { SUNContext_Free(&context); }

std::string reason(int flag, const std::string& detail) {
  switch (flag) {
    case CV_ERR_FAILURE:
      return "the error of a step stayed too large however short the step: a force that jumps or is far too stiff";
    case CV_CONV_FAILURE:
      return "the implicit equations of a step could not be solved however short the step: a force that jumps";
    case CV_RHSFUNC_FAIL:
    case CV_FIRST_RHSFUNC_ERR:
    case CV_REPTD_RHSFUNC_ERR:
    case CV_UNREC_RHSFUNC_ERR:
    case CV_QRHSFUNC_FAIL:
    case CV_FIRST_QRHSFUNC_ERR:
    case CV_REPTD_QRHSFUNC_ERR:
    case CV_UNREC_QRHSFUNC_ERR: return "forces or accelerations are not finite";
    case CV_TOO_MUCH_ACC: return "the relative tolerance is below what double precision can give";
    case CV_LSETUP_FAIL:
    case CV_LSOLVE_FAIL: return "the Jacobian of the motion is singular or not finite";
    default: return fmt::format("the integrator gave up (CVODES flag {}: {})", flag, detail);
  }
}

}  // namespace

struct BdfIntegrator::Solver {
  explicit Solver(OdeSystem& system) : system(system) {}

  OdeSystem& system;
  std::exception_ptr exception;  // thrown inside a callback, which C code must not see
  std::string message;           // CVODES' own words on its last error
  std::uint64_t steps = 0, jacobians = 0, failures = 0;  // before the last restart
  double step_begin = 0, time = 0;

  // In this order, so that they are released in the opposite one.
  Owner<SUNContext, free_context> context;
  Owner<N_Vector, free_vector> y, tolerances, z, y_scratch, z_scratch;
  Owner<SUNMatrix, free_matrix> matrix;
  Owner<SUNLinearSolver, free_linear_solver> linear_solver;
  Owner<void*, free_solver> cvodes;

  void demand(int flag, const char* what) {
    if (flag < 0) throw std::logic_error(fmt::format("{} failed with flag {}: {}", what, flag, message));
  }
  std::uint64_t count(int (*counter)(void*, long*)) const {
    long value = 0;
    if (time_is_valid) counter(cvodes, &value);
    return static_cast<std::uint64_t>(value);
  }
  bool time_is_valid = false;  // restarted at least once

  template <typename Function>
  int guarded(Function function) {
    try {
      return function() ? 0 : 1;  // 1: try a shorter step
    } catch (...) {
      exception = std::current_exception();
      return -1;
    }
  }
  static int derivative(realtype t, N_Vector y, N_Vector y_dot, void* self) {
    auto& solver = *static_cast<Solver*>(self);
    return solver.guarded(
        [&] { return solver.system.derivative(t, N_VGetArrayPointer(y), N_VGetArrayPointer(y_dot)); });
  }
  static int quadrature(realtype t, N_Vector y, N_Vector z_dot, void* self) {
    auto& solver = *static_cast<Solver*>(self);
    return solver.guarded(
        [&] { return solver.system.quadrature(t, N_VGetArrayPointer(y), N_VGetArrayPointer(z_dot)); });
  }
  static int project(realtype, N_Vector y, N_Vector correction, realtype, N_Vector error, void* self) {
    auto& solver = *static_cast<Solver*>(self);
    return solver.guarded([&] {
      solver.system.project(N_VGetArrayPointer(y), N_VGetArrayPointer(correction),
                            error ? N_VGetArrayPointer(error) : nullptr);
      return true;
    });
  }
  static void note_error(int code, const char*, const char*, char* text, void* self) {
    if (code != CV_WARNING) static_cast<Solver*>(self)->message = text;
  }
};

BdfIntegrator::BdfIntegrator(OdeSystem& system, const std::vector<double>& tolerances, int quadratures, double max_step)
    : solver_(std::make_unique<Solver>(system)) {
  Solver& s = *solver_;
  const auto n = static_cast<sunindextype>(tolerances.size());
  s.demand(SUNContext_Create(nullptr, &s.context.value), "SUNContext_Create");
  for (auto* vector : {&s.y, &s.tolerances, &s.y_scratch}) vector->value = N_VNew_Serial(n, s.context);
  for (auto* vector : {&s.z, &s.z_scratch}) vector->value = N_VNew_Serial(quadratures, s.context);
  std::copy(tolerances.begin(), tolerances.end(), N_VGetArrayPointer(s.tolerances));
  N_VConst(0, s.y);
  N_VConst(0, s.z);

  s.cvodes.value = CVodeCreate(CV_BDF, s.context);
  void* const cvodes = s.cvodes;
  s.demand(CVodeSetErrHandlerFn(cvodes, Solver::note_error, &s), "CVodeSetErrHandlerFn");
  s.demand(CVodeInit(cvodes, Solver::derivative, 0, s.y), "CVodeInit");
  s.demand(CVodeSetUserData(cvodes, &s), "CVodeSetUserData");
  s.demand(CVodeSVtolerances(cvodes, 0, s.tolerances), "CVodeSVtolerances");
  s.matrix.value = SUNDenseMatrix(n, n, s.context);
  s.linear_solver.value = SUNLinSol_Dense(s.y, s.matrix, s.context);
  s.demand(CVodeSetLinearSolver(cvodes, s.linear_solver, s.matrix), "CVodeSetLinearSolver");
  s.demand(CVodeSetProjFn(cvodes, Solver::project), "CVodeSetProjFn");
  s.demand(CVodeQuadInit(cvodes, Solver::quadrature, s.z), "CVodeQuadInit");
  s.demand(CVodeSetMaxErrTestFails(cvodes, kMaxErrorTestFailures), "CVodeSetMaxErrTestFails");
  s.demand(CVodeSetMaxConvFails(cvodes, kMaxConvergenceFailures), "CVodeSetMaxConvFails");
  s.demand(CVodeSetMinStep(cvodes, kShortestStep), "CVodeSetMinStep");
  if (max_step > 0) s.demand(CVodeSetMaxStep(cvodes, max_step), "CVodeSetMaxStep");
}

BdfIntegrator::~BdfIntegrator() = default;

void BdfIntegrator::restart(double t, const double* y, const double* z, int max_order) {
  assert(max_order >= 1 && max_order <= kHighestOrder);
  Solver& s = *solver_;
  s.steps = steps();
  s.jacobians = jacobians();
  s.failures = error_test_failures();
  std::copy_n(y, N_VGetLength(s.y), N_VGetArrayPointer(s.y));
  std::copy_n(z, N_VGetLength(s.z), N_VGetArrayPointer(s.z));
  s.demand(CVodeSetMaxOrd(s.cvodes, max_order), "CVodeSetMaxOrd");
  s.demand(CVodeReInit(s.cvodes, t, s.y), "CVodeReInit");
  s.demand(CVodeQuadReInit(s.cvodes, s.z), "CVodeQuadReInit");
  s.step_begin = s.time = t;
  s.time_is_valid = true;
}

void BdfIntegrator::watch_stability(bool watch) {
  solver_->demand(CVodeSetStabLimDet(solver_->cvodes, watch), "CVodeSetStabLimDet");
}

double BdfIntegrator::step(double stop) {
  Solver& s = *solver_;
  assert(stop > s.time);
  s.demand(CVodeSetStopTime(s.cvodes, stop), "CVodeSetStopTime");
  double reached = s.time;
  const int flag = CVode(s.cvodes, s.time + kOutlook, s.y, &reached, CV_ONE_STEP);
  if (s.exception) std::rethrow_exception(std::exchange(s.exception, nullptr));
  if (flag < 0) throw IntegrationFailed(reason(flag, s.message));
  s.step_begin = s.time;
  s.time = reached;
  return reached;
}

double BdfIntegrator::time() const { return solver_->time; }
double BdfIntegrator::step_begin() const { return solver_->step_begin; }

void BdfIntegrator::interpolate(double t, double* y, double* z) const {
  Solver& s = *solver_;
  assert(t >= s.step_begin && t <= s.time);
  if (s.step_begin == s.time) {  // nothing integrated since the restart
    std::copy_n(N_VGetArrayPointer(s.y), N_VGetLength(s.y), y);
    std::copy_n(N_VGetArrayPointer(s.z), N_VGetLength(s.z), z);
    return;
  }
  s.demand(CVodeGetDky(s.cvodes, t, 0, s.y_scratch), "CVodeGetDky");
  s.demand(CVodeGetQuadDky(s.cvodes, t, 0, s.z_scratch), "CVodeGetQuadDky");
  std::copy_n(N_VGetArrayPointer(s.y_scratch), N_VGetLength(s.y), y);
  std::copy_n(N_VGetArrayPointer(s.z_scratch), N_VGetLength(s.z), z);
}

int BdfIntegrator::order() const {
  int order = 0;
  CVodeGetLastOrder(solver_->cvodes, &order);
  return order;
}

std::uint64_t BdfIntegrator::steps() const { return solver_->steps + solver_->count(CVodeGetNumSteps); }
std::uint64_t BdfIntegrator::jacobians() const { return solver_->jacobians + solver_->count(CVodeGetNumJacEvals); }
std::uint64_t BdfIntegrator::error_test_failures() const {
  return solver_->failures + solver_->count(CVodeGetNumErrTestFails);
}

}  // namespace quayside::harness
