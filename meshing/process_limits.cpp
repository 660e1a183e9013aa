#include "meshing/process_limits.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

namespace vivify::meshing {

void become_quiet_child() {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit no_core = {0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  const int null = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (null < 0) return;
  dup2(null, STDOUT_FILENO);
  dup2(null, STDERR_FILENO);
}

void limit_own_memory(double megabytes) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  (void)megabytes;  // sanitizers map terabytes of address space
#else
  double pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const double bytes = pages * static_cast<double>(sysconf(_SC_PAGESIZE)) + megabytes * 1048576.0;
  rlimit limit = {};
  getrlimit(RLIMIT_AS, &limit);
  if (bytes < static_cast<double>(limit.rlim_max)) limit.rlim_cur = static_cast<rlim_t>(bytes);
  setrlimit(RLIMIT_AS, &limit);
#endif
}

}  // namespace vivify::meshing
