// Counts what the process takes from the heap, by malloc and its relatives: operator new and Eigen both end there.
#pragma once

#include <cstddef>

std::size_t heap_requests();
