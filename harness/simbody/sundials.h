// What the integrators of SUNDIALS share: ownership, callbacks from C, failures in words.
#pragma once

#include <exception>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_linearsolver.h>
#include <sunmatrix/sunmatrix_dense.h>

#include "harness/simbody/block_lu.h"
#include "harness/simbody/integrator.h"

namespace quayside::harness::sundials {

// The first step's bound is a fraction of the distance to the "next output", which one-step mode has none of.
constexpr double kOutlook = 1.0;  // [s]

// An impact can follow a long smooth flight: more halvings than the library's default (7) lie between their steps.
constexpr int kMaxErrorTestFailures = 30;
constexpr int kMaxConvergenceFailures = 30;

// Steps below this get nowhere: time itself is known to 1e-12 s after an hour [s].
constexpr double kShortestStep = 1e-11;

template <typename T, void (*release)(T)>
struct Owner {
  T value{};
  Owner() = default;
  Owner(const Owner&) = delete;
  Owner& operator=(const Owner&) = delete;
  ~Owner() {
    if (value) release(value);
  }
  operator T() const { return value; }
};
inline void free_vector(N_Vector v) { N_VDestroy(v); }
inline void free_matrix(SUNMatrix m) { SUNMatDestroy(m); }
inline void free_linear_solver(SUNLinearSolver s) { SUNLinSolFree(s); }
inline void free_context(SUNContext context) { SUNContext_Free(&context); }
using Vector = Owner<N_Vector, free_vector>;
using Matrix = Owner<SUNMatrix, free_matrix>;
using LinearSolver = Owner<SUNLinearSolver, free_linear_solver>;
using Context = Owner<SUNContext, free_context>;

inline double* data(N_Vector v) { return N_VGetArrayPointer(v); }

// The system as the library calls it. What is thrown inside of a callback, C code must not see: it is kept, and thrown
// again when the library has returned.
class Callbacks {
 public:
  explicit Callbacks(OdeSystem& system) : system_(system) {}

  bool threw() const { return exception_ != nullptr; }
  void rethrow() {
    if (exception_) std::rethrow_exception(std::exchange(exception_, nullptr));
  }
  const std::string& message() const { return message_; }  // the library's own words on its last error
  void demand(int flag, const char* what) const {
    if (flag < 0) throw std::logic_error(fmt::format("{} failed with flag {}: {}", what, flag, message_));
  }

  static int derivative(realtype t, N_Vector y, N_Vector y_dot, void* self) {
    return guarded(self, [&](OdeSystem& system) { return system.derivative(t, data(y), data(y_dot)); });
  }
  static int quadrature(realtype t, N_Vector y, N_Vector z_dot, void* self) {
    return guarded(self, [&](OdeSystem& system) { return system.quadrature(t, data(y), data(z_dot)); });
  }
  static int jacobian(realtype t, N_Vector y, N_Vector y_dot, SUNMatrix matrix, void* self, N_Vector, N_Vector,
                      N_Vector) {
    return guarded(self, [&](OdeSystem& system) {
      return system.jacobian(t, data(y), data(y_dot), SUNDenseMatrix_Data(matrix));
    });
  }
  static int project(realtype, N_Vector y, N_Vector correction, realtype, N_Vector error, void* self) {
    return guarded(self, [&](OdeSystem& system) {
      system.project(data(y), data(correction), error ? data(error) : nullptr);
      return true;
    });
  }
  static void note_error(int code, const char*, const char*, char* text, void* self) {
    if (code < 0) static_cast<Callbacks*>(self)->message_ = text;  // warnings are positive
  }

 private:
  template <typename Function>
  static int guarded(void* self, Function function) {
    auto& callbacks = *static_cast<Callbacks*>(self);
    try {
      return function(callbacks.system_) ? 0 : 1;  // 1: try a shorter step
    } catch (...) {
      callbacks.exception_ = std::current_exception();
      return -1;
    }
  }

  OdeSystem& system_;
  std::exception_ptr exception_;
  std::string message_;
};

// Solves with a dense matrix by its blocks; `lu` must outlive it.
SUNLinearSolver new_block_solver(BlockLu& lu, SUNContext context);

// CVODES and ARKODE have the same numbers for the same failures.
std::string reason(int flag, const char* library, const std::string& detail);

}  // namespace quayside::harness::sundials
