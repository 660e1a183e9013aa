// Deterministic parallel loops: the work is cut into the same pieces for any number of threads.
#pragma once

#include <cstddef>
#include <functional>

namespace vivify {

// Limits every later parallel loop of the process to `threads` threads (0: one per available processor).
void set_thread_count(int threads);
int thread_count();

// Calls body(i) for i = 0 … count − 1, in any order and on several threads. Bodies must write to places of their own;
// an exception of any body is rethrown here.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body);

}  // namespace vivify
