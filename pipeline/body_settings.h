// The settings of a body: their schema, and what ties them to one another.
#pragma once

#include <string>
#include <vector>

#include "common/error.h"
#include "common/schema.h"
#include "common/value.h"

namespace vivify::pipeline {

// What a body is made of, as its model asks for.
enum class BodyKind {
  solid,  // tetrahedra that fill the surface of `mesh`
  shell,  // the triangles of `mesh` themselves
  flat,   // triangles that fill `outline`
  rod     // edges along `outline`
};
BodyKind body_kind(const Value& body);
// Whether the body moves in the plane z = 0 only.
bool is_planar(BodyKind kind);

Schema body_schema();

// Adds one Error(usage) per setting of the body at `where` ("bodies[0]") that does not fit the others.
void check_body(const Value& body, const std::string& where, std::vector<Error>& errors);

// The setting that gives the shape of a body: `mesh` or `outline`.
// The settings of its controller, or of each of its behaviours, with their place in the body:
// "behavior[2].hop".
std::vector<std::pair<std::string, Value>> behaviors_of(const Value& body);

const Value& shape_of(const Value& body);

// The example poses of the rest space; none for a rest space without.
const std::vector<Value>& examples_of(const Value& body);

}  // namespace vivify::pipeline
