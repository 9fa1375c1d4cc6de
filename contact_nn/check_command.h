// `quayside contact check`: the committee judged from outside on millions of random poses.
#pragma once

namespace CLI {
class App;
}

namespace quayside::contact_nn {

void add_check_command(CLI::App& contact_app);

}  // namespace quayside::contact_nn
