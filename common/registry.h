// Explicit tables of named things: one line in a table makes a new controller, material, backend or stage known.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/error.h"
#include "common/text.h"

namespace vivify {

// The entry of `table` whose member `name` is `name`. Throws Error(internal), since names come through the schema.
template <class Entry>
const Entry& find_entry(std::span<const Entry> table, std::string_view name, std::string_view what) {
  for (const Entry& entry : table) {
    if (entry.name == name) return entry;
  }
  throw Error(ErrorKind::internal, "no " + std::string(what) + " is called '" + std::string(name) + "'");
}

}  // namespace vivify
