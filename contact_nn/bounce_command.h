// `quayside contact bounces`: does a contact law make energy?
#pragma once

namespace CLI {
class App;
}

namespace quayside::contact_nn {

void add_bounce_command(CLI::App& contact_app);

}  // namespace quayside::contact_nn
