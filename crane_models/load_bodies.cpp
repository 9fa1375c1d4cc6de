#include "crane_models/load_bodies.h"

namespace quayside::crane_models {

void set_mass_properties(Body& body, const spreader::MassProperties& properties) {
  body.mass = properties.mass;
  body.p_BBcm = properties.p_BBcm;
  body.I_BBcm_B = properties.I_BBcm_B;
}

spreader::MassProperties mass_properties(const Body& body) { return {body.mass, body.p_BBcm, body.I_BBcm_B}; }

Body box_body(const std::string& name, const Eigen::Vector3d& size, double mass) {
  Body body;
  body.name = name;
  set_mass_properties(body, spreader::uniform_box(mass, size));
  body.boxes = {{size / 2, Pose::Identity(), name}};
  return body;
}

Body container_body(const std::string& name, spreader::ContainerSize size, double mass,
                    const Eigen::Vector3d& p_BBcm) {
  Body body = box_body(name, spreader::container_data(size).size, mass);
  body.p_BBcm = p_BBcm;
  return body;
}

Pose container_bottom(spreader::ContainerSize size) {
  Pose X_BR = Pose::Identity();
  X_BR.translation().z() = -spreader::container_data(size).size.z() / 2;
  return X_BR;
}

void fix_to_world(Body& body) {
  body.joint = Joint{};
  body.joint.type = JointType::fixed;
  body.joint.X_PF = body.X_WB;
}

}  // namespace quayside::crane_models
