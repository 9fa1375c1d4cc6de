// quayside contact energy: which contact model makes energy, in an integrator?
#pragma once

namespace CLI {
class App;
}

namespace quayside::contact_nn {

void add_energy_command(CLI::App& contact_app);

}  // namespace quayside::contact_nn
