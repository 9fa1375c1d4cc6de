#include "contact_nn/paper/tuning.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <ostream>
#include <set>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

namespace quayside::contact_nn::paper {

namespace {

const char* const columns =
    "number,hidden 1,hidden 2,adaptation,momentum,amplitude,epochs,best epoch,training [s],training ME,training MAE,"
    "training RMSE,validation ME,validation MAE,validation RMSE,external ME,external MAE,external RMSE";
constexpr std::size_t column_count = 18;

// All that the numbers depend on: a file begun with other settings cannot be continued.
std::string settings_line(const TuningOptions& options) {
  const Problem& p = options.problem;
  return fmt::format("# {} poses, {}, {}/{}/{} patterns, data seed {}, tuning seed {}, at most {} epochs, patience {}",
                     p.reading == Reading::valid ? "valid" : "unfiltered", describe(p.subset), p.sizes.training,
                     p.sizes.validation, p.sizes.external, p.seed, options.seed, options.epochs, options.patience);
}

std::string row_text(const TunedNetwork& n) {
  std::string text =
      fmt::format("{},{},{},{:.9g},{:.9g},{:.9g},{},{},{:.3f}", n.number, n.recipe.hidden[0], n.recipe.hidden[1],
                  n.recipe.adaptation, n.recipe.momentum, n.recipe.amplitude, n.epochs, n.best_epoch, n.seconds);
  for (const OutputErrors* e : {&n.training, &n.validation, &n.external}) {
    text += fmt::format(",{:.9g},{:.9g},{:.9g}", e->mean, e->absolute, e->square);
  }
  return text;
}

TunedNetwork parse_row(const std::string& line, const std::string& where) {
  std::vector<double> x;
  std::istringstream fields(line);
  for (std::string field; std::getline(fields, field, ',');) {
    char* end = nullptr;
    x.push_back(std::strtod(field.c_str(), &end));
    if (end == field.c_str() || *end != '\0') x.clear();
  }
  if (x.size() != column_count)
    throw std::invalid_argument(where + ": not a row of a tuning; delete it or take another file");
  TunedNetwork n;
  n.number = static_cast<int>(x[0]);
  n.recipe.hidden = {static_cast<int>(x[1]), static_cast<int>(x[2])};
  n.recipe.adaptation = x[3];
  n.recipe.momentum = x[4];
  n.recipe.amplitude = x[5];
  n.epochs = static_cast<int>(x[6]);
  n.best_epoch = static_cast<int>(x[7]);
  n.seconds = x[8];
  n.training = {x[9], x[10], x[11]};
  n.validation = {x[12], x[13], x[14]};
  n.external = {x[15], x[16], x[17]};
  return n;
}

// The networks that the file has, begun anew if there is none. A last line that was cut off is taken away.
std::vector<TunedNetwork> finished_networks(const TuningOptions& options) {
  namespace fs = std::filesystem;
  const std::string settings = settings_line(options);
  if (!fs::exists(options.file) || fs::file_size(options.file) == 0) {
    std::ofstream out(options.file);
    out << settings << '\n' << columns << '\n';
    out.close();
    if (!out) throw std::runtime_error(fmt::format("{} cannot be written: does its folder exist?", options.file));
    return {};
  }
  std::ifstream in(options.file, std::ios::binary);
  std::ostringstream content;
  content << in.rdbuf();
  std::string text = content.str();
  const std::size_t whole = text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1;
  if (whole < text.size()) {
    text.resize(whole);
    fs::resize_file(options.file, whole);
  }
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  if (line != settings) {
    throw std::invalid_argument(
        fmt::format("{} was begun with other settings\n  there: {}\n  now:   {}\ntake another file "
                    "or the same settings",
                    options.file, line, settings));
  }
  std::vector<TunedNetwork> networks;
  std::getline(lines, line);  // the columns' names
  for (int number = 3; std::getline(lines, line); ++number) {
    networks.push_back(parse_row(line, fmt::format("{}:{}", options.file, number)));
  }
  return networks;
}

double log_uniform(Random& random, double low, double high) {
  return std::exp(random.uniform(std::log(low), std::log(high)));
}

}  // namespace

Recipe random_recipe(const TuningOptions& options, int number) {
  Random random(options.seed * 1000003 + static_cast<std::uint64_t>(number));  // a prime: seeds share no networks
  Recipe recipe = recipe_for(Method::momentum);
  recipe.hidden = {5 + static_cast<int>(random.below(26)), 5 + static_cast<int>(random.below(26))};
  recipe.adaptation = log_uniform(random, 0.001, 0.2);
  recipe.momentum = 1 - log_uniform(random, 0.02, 1);
  recipe.amplitude = log_uniform(random, 0.03, 2);
  recipe.batch = 16;
  recipe.epochs = options.epochs;
  recipe.patience = options.patience;
  recipe.seed = options.seed * 1000003 + static_cast<std::uint64_t>(number);
  return recipe;
}

// Threads take the next number that the file lacks; each result is written at once, so a stop loses at most one network
// per thread.
std::vector<TunedNetwork> tune(const TuningOptions& options) {
  std::vector<TunedNetwork> networks = finished_networks(options);
  std::set<int> have;
  for (const TunedNetwork& n : networks) have.insert(n.number);
  std::vector<int> missing;
  for (int k = 0; k < options.networks; ++k) {
    if (have.count(k) == 0) missing.push_back(k);
  }
  const auto stopped = [&] { return options.stop != nullptr && options.stop->load(); };
  if (!missing.empty() && !stopped()) {
    const Data data = data_of(draw(options.problem), options.problem.coding);
    std::ofstream out(options.file, std::ios::app);
    std::mutex mutex;  // of `out`, `networks`, `failure` and `progress`
    std::exception_ptr failure;
    std::atomic<std::size_t> next{0};
    int in_this_run = 0;
    const auto work = [&] {
      try {
        for (std::size_t i = next++; i < missing.size() && !stopped(); i = next++) {
          TunedNetwork n;
          n.number = missing[i];
          n.recipe = random_recipe(options, n.number);
          n.recipe.stopped = stopped;
          const auto begin = std::chrono::steady_clock::now();
          const Trained trained = train(data.training, data.validation, n.recipe);
          if (trained.stopped) return;
          n.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
          n.epochs = trained.epochs;
          n.best_epoch = trained.best_epoch;
          const Errors errors = errors_of(trained.network, data, options.problem.coding.encoding);
          n.training = errors.training;
          n.validation = errors.validation;
          n.external = errors.external;
          const std::lock_guard<std::mutex> lock(mutex);
          out << row_text(n) << std::endl;
          if (!out) throw std::runtime_error(options.file + " cannot be written: is the disk full?");
          networks.push_back(n);
          options.progress(static_cast<int>(networks.size()), ++in_this_run);
        }
      } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex);
        failure = std::current_exception();
        next = missing.size();
      }
    };
    const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
    std::vector<std::thread> threads;
    for (unsigned k = 0; k < (options.threads > 0 ? static_cast<unsigned>(options.threads) : cores); ++k)
      threads.emplace_back(work);
    for (std::thread& thread : threads) thread.join();
    if (failure) std::rethrow_exception(failure);
  }
  std::sort(networks.begin(), networks.end(), [](const auto& a, const auto& b) { return a.number < b.number; });
  return networks;
}

void print(const std::vector<TunedNetwork>& networks, std::ostream& out) {
  std::vector<const TunedNetwork*> order;
  for (const TunedNetwork& n : networks) order.push_back(&n);
  const auto error = [](const TunedNetwork* n) { return n->validation.absolute; };
  std::sort(order.begin(), order.end(), [&](auto* a, auto* b) { return error(a) < error(b); });
  out << fmt::format("The best of {} networks on the validation set:\n\n", networks.size())
      << "| network | hidden | adaptation | momentum | amplitude | epochs | training MAE | validation MAE | external "
         "ME / MAE / "
         "RMSE |\n|---|---|---|---|---|---|---|---|---|\n";
  for (std::size_t i = 0; i < std::min<std::size_t>(10, order.size()); ++i) {
    const TunedNetwork& n = *order[i];
    out << fmt::format(
        "| {} | {} x {} | {:.4f} | {:.3f} | {:.3f} | {} | {:.4f} | {:.4f} | {:.4f} / {:.4f} / {:.4f} |\n", n.number,
        n.recipe.hidden[0], n.recipe.hidden[1], n.recipe.adaptation, n.recipe.momentum, n.recipe.amplitude,
        n.best_epoch, n.training.absolute, n.validation.absolute, n.external.mean, n.external.absolute,
        n.external.square);
  }
  if (networks.size() < 8) return;
  out << "\nValidation MAE, best / median, by quarters of each constant:\n\n| constant | lowest | | | highest "
         "|\n|---|---|---|---|---|\n";
  struct Constant {
    const char* name;
    double (*of)(const TunedNetwork&);
  };
  const Constant constants[] = {{"hidden units, both layers",
                                 [](const TunedNetwork& n) { return double(n.recipe.hidden[0] + n.recipe.hidden[1]); }},
                                {"adaptation", [](const TunedNetwork& n) { return n.recipe.adaptation; }},
                                {"momentum", [](const TunedNetwork& n) { return n.recipe.momentum; }},
                                {"adaptation / (1 - momentum)",
                                 [](const TunedNetwork& n) { return n.recipe.adaptation / (1 - n.recipe.momentum); }},
                                {"amplitude", [](const TunedNetwork& n) { return n.recipe.amplitude; }}};
  for (const Constant& constant : constants) {
    std::sort(order.begin(), order.end(), [&](auto* a, auto* b) { return constant.of(*a) < constant.of(*b); });
    out << "| " << constant.name;
    for (std::size_t quarter = 0; quarter < 4; ++quarter) {
      const std::size_t begin = quarter * order.size() / 4, end = (quarter + 1) * order.size() / 4;
      std::vector<double> errors;
      for (std::size_t i = begin; i < end; ++i) errors.push_back(error(order[i]));
      std::sort(errors.begin(), errors.end());
      out << fmt::format(" | {:.3g} to {:.3g}: {:.3f} / {:.3f}", constant.of(*order[begin]),
                         constant.of(*order[end - 1]), errors.front(), errors[errors.size() / 2]);
    }
    out << " |\n";
  }
}

}  // namespace quayside::contact_nn::paper
