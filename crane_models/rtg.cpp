#include "crane_models/rope_crane.h"

namespace quayside::crane_models {

RopeCrane rubber_tyred_gantry() {
  RopeCrane crane;
  crane.gantry = {2.25, 0.2, 0, 0.5};
  crane.trolley = {1.17, 0.35, 0, 0.7};
  crane.hoist = {0.52, 0.35, 0, 0.8};
  crane.trim = {0.04, 0.04};
  crane.list = {0.015, 0.015};
  crane.skew = {0.01, 0.01};
  crane.trolley_sheaves = {6.6, 3.6};
  crane.spreader_sheaves = {4.6, 1.6};
  crane.rope_stiffness = 60e6;
  crane.load_side.spreader.mass = 9.5e3;  // lighter than on the quay: no headblock of its own
  return crane;
}

}  // namespace quayside::crane_models
