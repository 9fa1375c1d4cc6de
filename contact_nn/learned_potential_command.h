// `quayside contact potential train | evaluate`: the network for the contact potential, made and measured.
#pragma once

namespace CLI {
class App;
}

namespace quayside::contact_nn {

// Adds `potential` to the command `contact`.
void add_learned_commands(CLI::App& contact);

}  // namespace quayside::contact_nn
