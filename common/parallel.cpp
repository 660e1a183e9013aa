#include "common/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <memory>

#ifdef VIVIFY_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace vivify {
namespace {

std::unique_ptr<tbb::global_control> limit;

// What comes before what in a parallel loop, told to the thread sanitizer, which cannot see into the library:
// all that was done before the loop comes before every body, and every body before all that is done after the
// loop.
class Order {
 public:
#ifdef VIVIFY_THREAD_SANITIZER
  Order() { __tsan_release(&begin_); }
  ~Order() { __tsan_acquire(&end_); }
  class Body {
   public:
    explicit Body(Order& order) : order_(order) { __tsan_acquire(&order_.begin_); }
    ~Body() { __tsan_release(&order_.end_); }

   private:
    Order& order_;
  };

 private:
  char begin_ = 0, end_ = 0;
#else
  struct Body {
    explicit Body(Order&) {}
  };
#endif
};

}  // namespace

void set_thread_count(int threads) {
  limit.reset();
  if (threads > 0) {
    limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                  static_cast<std::size_t>(threads));
  }
}

int thread_count() {
  return static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  Order order;
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    const Order::Body running(order);
    body(i);
  });
}

}  // namespace vivify
