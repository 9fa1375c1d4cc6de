#include "crane_models/rope_crane.h"

namespace quayside::crane_models {

RopeCrane quayside_crane() {
  RopeCrane crane;
  crane.gantry = {0.75, 0.15, 0, 0.3};
  crane.trolley = {3.0, 0.7, 0, 1.2};
  crane.hoist = {1.2, 0.7, 0, 1.5};
  crane.trim = {0.05, 0.05};
  crane.list = {0.01, 0.01};
  crane.skew = {0.01, 0.01};
  crane.trolley_sheaves = {5.78, 1.30};
  crane.spreader_sheaves = {5.55, 0.80};
  crane.rope_stiffness = 84e6;
  return crane;
}

}  // namespace quayside::crane_models
