// Settings of the memory of the whole process.
#pragma once

namespace vivify {

// Keeps memory that was freed instead of giving it back to the system. Every step of a simulation makes and
// frees the same matrices of some hundred kilobytes; giving them back costs a fifth to a third of an
// iteration in page faults. For programs, at their start.
void keep_freed_memory();

}  // namespace vivify
