// quayside contact dataset|train|query|bench: the contact module by itself, without a crane around it.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "contact_nn/contact.h"
#include "contact_nn/dataset.h"

namespace CLI {
class App;
}

namespace quayside::contact_nn {

// Adds the subcommand `contact` with its own subcommands.
void add_contact_commands(CLI::App& app);

// Reads rows `id, ax,ay,az, bx,by,bz, px,py,pz, qw,qx,qy,qz`: half extents of A and B [m], B's centre in A [m], B's
// orientation in A; a header line is skipped. Writes a header and rows `id, gap, nx,ny,nz, class, n`, then n times
// `px,py,pz,depth`, in A's frame, in the order of the input, with all digits of a double. Throws std::invalid_argument
// for a row that cannot be answered, with its line and what to change. `name` stands for the input in messages.
void answer_queries(std::istream& poses, const std::string& name, const ContactModule& module, double margin,
                    std::ostream& answers);

// Writes pairs as `answer_queries` reads them.
void write_pairs(const std::vector<BoxPair>& pairs, std::ostream& out);

}  // namespace quayside::contact_nn
