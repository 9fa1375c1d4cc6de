#include "tests/benchmarks/peers/bounce_table.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "contact_nn/free_box.h"

namespace quayside::peers {
namespace {

using contact_nn::ContactForce;
using contact_nn::Pose;

constexpr double kStiffness = 6e8;  // [N/m]

// A method whose answers jump all the time would keep the integrator at its shortest step for ever: such a bounce is given up.
constexpr long kMostEvaluations = 20000;
constexpr std::size_t kMostGivenUp = 50;  // after that the method is not asked any more
struct GivenUp {};

const Box kContainer{{6.096, 1.219, 1.2955}};  // 40 ft

// Asks a method about one pair.
Answer ask(Contender& contender, std::vector<Placed>& pair) {
  contender.load(pair);
  contender.query(0);
  return contender.answer();
}

bool gives_what_a_spring_needs(Contender& contender) {
  Pose above = Pose::Identity();
  above.translation().z() = 2 * kContainer.half.z() - 1e-3;
  std::vector<Placed> pair{{kContainer, kContainer, Pose::Identity(), above}};
  const Answer answer = ask(contender, pair);
  return std::isfinite(answer.depth) && answer.point_W.allFinite();
}

}  // namespace

std::string bounce_table(const Contenders& contenders, std::size_t bounces, std::uint64_t seed) {
  std::string out = fmt::format(
      "\n## Energy from nowhere: {} elastic bounces under one spring at the reported contact\n\n"
      "| method | contacts | given up | gain more than 0.1 % | lose more than 0.1 % | most gained |\n"
      "| --- | --- | --- | --- | --- | --- |\n", bounces);
  for (const auto& contender : contenders) {
    if (contender->kind == Kind::mesh || !gives_what_a_spring_needs(*contender)) continue;
    std::vector<Placed> pair{{kContainer, kContainer, Pose::Identity(), Pose::Identity()}};
    long evaluations = 0;
    const auto spring = [&](const Pose& X_AB, const contact_nn::RelativeVelocity&) {
      if (++evaluations > kMostEvaluations) throw GivenUp();
      pair[0].X_WB = Placement(X_AB);
      const Answer answer = ask(*contender, pair);
      ContactForce force;
      if (!answer.touching || !(answer.depth > 0)) return force;
      force.f_A = kStiffness * answer.depth * answer.n_W;
      force.t_A = answer.point_W.cross(force.f_A);
      force.potential_energy = 0.5 * kStiffness * answer.depth * answer.depth;
      return force;
    };
    contact_nn::Random random(seed);
    std::vector<contact_nn::Rebound> rebounds;
    std::size_t given_up = 0;
    for (std::size_t i = 0; i < bounces && given_up < kMostGivenUp; ++i) {
      evaluations = 0;
      try {
        rebounds.push_back(contact_nn::rebound(contact_nn::throw_from_anywhere(kContainer, kContainer, random), spring));
      } catch (const GivenUp&) {
        ++given_up;
      }
    }
    const contact_nn::ReboundFigures f = contact_nn::figures_of(rebounds);
    const double share = 100.0 / std::max(f.touched, 1);
    out += fmt::format("| {} | {} | {} | {:.2f} % | {:.2f} % | {:+.2g} % |\n", contender->name, f.touched, given_up,
                       share * f.gained, share * f.lost, 100 * f.most_gained);
  }
  return out;
}

}  // namespace quayside::peers
