#include "common/memory.h"

#include <malloc.h>

namespace vivify {

void keep_freed_memory() {
  static constexpr int kLarge = 1 << 28, kPad = 1 << 24;  // bytes
  mallopt(M_MMAP_THRESHOLD, kLarge);
  mallopt(M_TRIM_THRESHOLD, kLarge);
  mallopt(M_TOP_PAD, kPad);
}

}  // namespace vivify
