#include "harness/simbody/sundials.h"

#include <arkode/arkode.h>
#include <cvodes/cvodes.h>

namespace quayside::harness::sundials {

static_assert(ARK_ERR_FAILURE == CV_ERR_FAILURE && ARK_CONV_FAILURE == CV_CONV_FAILURE &&
              ARK_RHSFUNC_FAIL == CV_RHSFUNC_FAIL && ARK_FIRST_RHSFUNC_ERR == CV_FIRST_RHSFUNC_ERR &&
              ARK_REPTD_RHSFUNC_ERR == CV_REPTD_RHSFUNC_ERR && ARK_UNREC_RHSFUNC_ERR == CV_UNREC_RHSFUNC_ERR &&
              ARK_TOO_MUCH_ACC == CV_TOO_MUCH_ACC && ARK_LSETUP_FAIL == CV_LSETUP_FAIL &&
              ARK_LSOLVE_FAIL == CV_LSOLVE_FAIL);

SUNLinearSolver new_block_solver(BlockLu& lu, SUNContext context) {
  SUNLinearSolver solver = SUNLinSolNewEmpty(context);
  solver->content = &lu;
  solver->ops->gettype = [](SUNLinearSolver) { return SUNLINEARSOLVER_DIRECT; };
  solver->ops->initialize = [](SUNLinearSolver) { return static_cast<int>(SUNLS_SUCCESS); };
  solver->ops->setup = [](SUNLinearSolver self, SUNMatrix matrix) {
    const bool done = static_cast<BlockLu*>(self->content)->factor(SUNDenseMatrix_Data(matrix));
    return static_cast<int>(done ? SUNLS_SUCCESS : SUNLS_LUFACT_FAIL);
  };
  solver->ops->solve = [](SUNLinearSolver self, SUNMatrix, N_Vector x, N_Vector b, realtype) {
    if (x != b) N_VScale(1, b, x);
    static_cast<BlockLu*>(self->content)->solve(data(x));
    return static_cast<int>(SUNLS_SUCCESS);
  };
  solver->ops->free = [](SUNLinearSolver self) {
    SUNLinSolFreeEmpty(self);
    return static_cast<int>(SUNLS_SUCCESS);
  };
  return solver;
}

std::string reason(int flag, const char* library, const std::string& detail) {
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
    default: return fmt::format("the integrator gave up ({} flag {}: {})", library, flag, detail);
  }
}

}  // namespace quayside::harness::sundials
