// The committee: a gate network says where to look, closed form evaluates there, a check proves that nothing was missed.
// It is the paper's section VII completed: a classifier first, then the expert for the class.
//
// `potential`: boxes that some axis separates need no network: no force. Otherwise the gate names the faces and cells
// that may carry force. Every other piece must be shown to be empty from the ranges of its distances, else the answer is
// the exact law's and is counted in `fallbacks`. Pieces left out are empty in the exact law as well and the rest is
// summed in the same order: both models agree to the last bit, whatever the weights of the gate.
//
// `points`: the gate ranks the 15 separating axes, and the force stands when the best one is among its first three; else
// the manifold is made by the exact path and counted in `fallbacks`. The check is the whole separating-axis test, since
// four axes at a time that costs less (20 ns) than three axes and a proof that no other beats them. Both models agree to
// the last bit here as well.
//
// The geometry query asks no gate, under either law: its check alone is the answer, and a gate in front of it made it
// twice as slow for the same bits. How good the gate is by itself is measured by `quayside contact check`.
//
// What the gates gain in forces: nothing in time, in single calls. A proof that no piece or axis was missed looks at all
// of them, and so could have named them; the network comes on top. `quayside contact bench` measures it. A check of the
// answer alone, cheaper than the search for it, would change that.
#pragma once

#include <memory>

#include "contact_nn/contact.h"
#include "contact_nn/onnx_file.h"

namespace quayside::contact_nn {

// Throws std::invalid_argument for values out of range, std::runtime_error for a network file that cannot be used.
// `settings.network` replaces the gate of `settings.law`.
std::unique_ptr<ContactModule> make_committee_module(const ContactSettings& settings);

// The gate that ships with the module, for one law.
NetworkFile shipped_gate(Law law);

}  // namespace quayside::contact_nn
