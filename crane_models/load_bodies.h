// Bodies of a Scene made of one box: containers and plain boxes. Their frame B is the centre of the box.
#pragma once

#include <string>

#include "crane_models/scene.h"
#include "spreader/container.h"
#include "spreader/mass_properties.h"

namespace quayside::crane_models {

void set_mass_properties(Body& body, const spreader::MassProperties& properties);
spreader::MassProperties mass_properties(const Body& body);

// Uniform density; `size`: full edges [m]. Free, at the world's origin.
Body box_body(const std::string& name, const Eigen::Vector3d& size, double mass);

// A container whose mass is spread as in a uniform box, about a centre of gravity at p_BBcm. Free, at the world's
// origin.
Body container_body(const std::string& name, spreader::ContainerSize size, double mass,
                    const Eigen::Vector3d& p_BBcm);

// Centre of the bottom face of a container, where its position is reported.
Pose container_bottom(spreader::ContainerSize size);

// Holds a body at its start.
void fix_to_world(Body& body);

}  // namespace quayside::crane_models
