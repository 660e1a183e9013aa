// Triangle surfaces to simulate as thin shells.
#pragma once

#include <string>
#include <vector>

#include "common/mesh.h"

namespace vivify::meshing {

struct ShellMesh {
  TriangleMesh mesh;               // V and F; every vertex is used
  std::vector<std::string> notes;  // what was done, in plain words
  double min_angle = 0;            // degrees
};

// A shell from a surface, open or closed: vertices in the same place are joined, faces without area dropped,
// and faces oriented alike (outward when closed). With another wanted number of vertices (0: as it is) it is
// remeshed evenly until it has that many within 15 %; borders, creases and their corners stay. Throws
// Error(geometry) that names the place when an edge belongs to more than two faces, parts touch only in a
// vertex, or the surface has one side only (a Moebius strip), and when the wanted number is not reached.
ShellMesh shell_mesh(const TriangleMesh& surface, int vertices);

}  // namespace vivify::meshing
