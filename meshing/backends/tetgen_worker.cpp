// vivify_tetgen: reads points, facets and switches from standard input, runs TetGen, writes the tetrahedra to
// standard output (meshing/backends/tetgen.cpp is the other end). Exit code: 0, or kTetgenExit + TetGen's own
// code.
#include <fcntl.h>
#include <tetgen.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "common/mesh.h"
#include "meshing/backends/tetgen_protocol.h"
#include "meshing/byte_stream.h"
#include "meshing/process_limits.h"

using namespace vivify;
using namespace vivify::meshing;

namespace {

// TetGen frees its memory before it throws an int, and its destructor frees it again while the stack unwinds.
// Nothing catches the int here, so that the stack is not unwound and this handler still sees the code.
[[noreturn]] void exit_with_code_of_exception() {
  try {
    throw;
  } catch (int code) {
    _exit(kTetgenExit + code);
  } catch (const std::bad_alloc&) {
    _exit(kOutOfMemoryExit);
  } catch (...) {
    _exit(kTetgenExit);
  }
}

std::vector<std::byte> read_all(int file) {
  std::vector<std::byte> bytes, buffer(1 << 16);
  for (;;) {
    const ssize_t count = read(file, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return bytes;
    bytes.insert(bytes.end(), buffer.begin(), buffer.begin() + count);
  }
}

bool write_all(int file, const std::vector<std::byte>& bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = write(file, bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    done += static_cast<std::size_t>(count);
  }
  return true;
}

void fill_input(tetgenio& io, const Points& V, const Triangles& F) {
  io.firstnumber = 0;
  io.numberofpoints = static_cast<int>(V.rows());
  io.pointlist = new REAL[3 * static_cast<std::size_t>(V.rows())];
  std::copy(V.data(), V.data() + V.size(), io.pointlist);
  io.numberoffacets = static_cast<int>(F.rows());
  io.facetlist = new tetgenio::facet[static_cast<std::size_t>(F.rows())];
  io.facetmarkerlist = new int[static_cast<std::size_t>(F.rows())];
  for (int f = 0; f < io.numberoffacets; ++f) {
    tetgenio::facet& facet = io.facetlist[f];
    tetgenio::init(&facet);
    facet.numberofpolygons = 1;
    facet.polygonlist = new tetgenio::polygon[1];
    facet.polygonlist[0].numberofvertices = 3;
    facet.polygonlist[0].vertexlist = new int[3];
    for (int k = 0; k < 3; ++k) facet.polygonlist[0].vertexlist[k] = F(f, k);
    io.facetmarkerlist[f] = f + 1;
  }
}

}  // namespace

int main() {
  const int answer_file = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
  become_quiet_child();
  std::set_terminate(exit_with_code_of_exception);

  const std::vector<std::byte> request = read_all(STDIN_FILENO);
  ByteReader reader(request);
  double megabytes = 0;
  std::string switches;
  Points V;
  Triangles F;
  reader.get(megabytes);
  reader.get(switches);
  reader.get(V);
  reader.get(F);
  limit_own_memory(megabytes);

  tetgenio in, out;
  fill_input(in, V, F);
  tetrahedralize(switches.data(), &in, &out);

  const Points X = Eigen::Map<const Points>(out.pointlist, out.numberofpoints, 3);
  Tetrahedra T(out.numberoftetrahedra, 4);
  for (int t = 0; t < out.numberoftetrahedra; ++t) {
    for (int k = 0; k < 4; ++k) T(t, k) = out.tetrahedronlist[t * out.numberofcorners + k];
  }
  const Triangles B = Eigen::Map<const Triangles>(out.trifacelist, out.numberoftrifaces, 3);
  Eigen::VectorXi markers = Eigen::VectorXi::Zero(out.numberoftrifaces);
  if (out.trifacemarkerlist != nullptr) {
    markers = Eigen::Map<const Eigen::VectorXi>(out.trifacemarkerlist, out.numberoftrifaces);
  }
  ByteWriter writer;
  writer.put(X).put(T).put(B).put(markers);
  _exit(write_all(answer_file, writer.take()) ? 0 : 1);
}
