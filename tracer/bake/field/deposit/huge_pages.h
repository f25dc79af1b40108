// Large pages for sums that deposits strike at random.
#pragma once

#include <cstddef>

namespace ivory {

// Asks the system to back these bytes, not yet written, by pages of 2 MB: with pages of 4 KB nearly every deposit would
// also miss the table of pages. A request: nothing else depends on whether it is met.
void ask_for_huge_pages(void* begin, std::size_t bytes);

}  // namespace ivory
