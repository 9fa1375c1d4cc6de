#include "contact_nn/paper/experiment.h"

#include <chrono>

namespace quayside::contact_nn::paper {

Poses draw(const Problem& problem) {
  Random random(problem.seed);
  Poses poses;
  const auto take = [&](std::size_t count) {
    return draw_poses(count, problem.reading, problem.subset, random, poses.counts);
  };
  poses.training = take(problem.sizes.training);
  poses.validation = take(problem.sizes.validation);
  poses.external = take(problem.sizes.external);
  return poses;
}

Data data_of(const Poses& poses, const Coding& coding) {
  return {patterns(poses.training, coding), patterns(poses.validation, coding), patterns(poses.external, coding)};
}

namespace {

template <class Answer>
Errors errors_with(Answer answer, const Data& data, Encoding encoding) {
  Errors errors;
  const auto of = [&](const Samples& samples) {
    return output_errors(answer(samples), samples.targets.cast<double>());
  };
  errors.training = of(data.training);
  errors.validation = of(data.validation);
  errors.external = of(data.external);
  errors.physical = physical_errors(answer(data.external), data.external.targets.cast<double>(), encoding);
  return errors;
}

}  // namespace

Errors errors_of(const Network& network, const Data& data, Encoding encoding) {
  const auto answer = [&](const Samples& samples) { return network(samples.inputs.cast<double>()); };
  return errors_with(answer, data, encoding);
}

Errors errors_of_constant(const Data& data, Encoding encoding) {
  const Eigen::VectorXd constant = best_constant(data.training.targets);
  const auto answer = [&](const Samples& samples) -> Eigen::MatrixXd { return constant.replicate(1, samples.size()); };
  return errors_with(answer, data, encoding);
}

Outcome best_of(int starts, const Data& data, Encoding encoding, Recipe recipe) {
  const auto begin = std::chrono::steady_clock::now();
  Outcome best;
  double lowest = 0;
  for (int start = 0; start < starts; ++start, ++recipe.seed) {
    Trained trained = train(data.training, data.validation, recipe);
    const Eigen::MatrixXd outputs = trained.network(data.validation.inputs.cast<double>());
    const double error = output_errors(outputs, data.validation.targets.cast<double>()).absolute;
    if (start == 0 || error < lowest) {
      lowest = error;
      best.trained = std::move(trained);
    }
  }
  best.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  best.errors = errors_of(best.trained.network, data, encoding);
  return best;
}

}  // namespace quayside::contact_nn::paper
