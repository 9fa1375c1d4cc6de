// Counts what the process allocates through operator new: shows that a function allocates nothing.
#pragma once

#include <cstddef>

std::size_t allocation_count();
