#include "common/hdf5_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "common/error.h"
#include "common/rng.h"
#include "tests/common/temporary_folder.h"

namespace vivify {
namespace {

using ::testing::HasSubstr;
using testing_support::TemporaryFolder;
using testing_support::write_quickly;

void fill(Hdf5Writer& writer) {
  CounterRng rng(1);
  RowMatrixXd matrix(101, 3);
  for (Eigen::Index i = 0; i < matrix.size(); ++i) matrix.data()[i] = rng.uniform(-1, 1);
  writer.put("/bodies/cup/x", matrix);
  writer.put("/bodies/cup/T", RowMatrixXi{{1, 2, 3, 4}, {5, 6, 7, -8}});
  writer.put("/bodies/bowl/p", Eigen::VectorXd(Eigen::VectorXd::LinSpaced(24, 0, 1)));
  writer.put("/bodies/bowl/parts", Eigen::VectorXi(Eigen::VectorXi::LinSpaced(5, 0, 4)));
  writer.put("/t", 0.1);
  writer.put("/step", std::int64_t{1} << 40);
  writer.put("/key", std::string("größe"));
  writer.put("/empty_text", std::string());
  writer.put("/names", std::vector<std::string>{"a", "", "longer name"});
  writer.put("/no_names", std::vector<std::string>{});
  writer.put("/nothing", RowMatrixXd(0, 3));
  writer.put_attribute("schema_version", 3);
}

std::string error_of(const std::function<void()>& action, ErrorKind kind = ErrorKind::io) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind);
    return error.full_text();
  }
  ADD_FAILURE() << "nothing was thrown";
  return "";
}

TEST(Hdf5File, GivesBackWhatWasWritten) {
  const TemporaryFolder folder;
  Hdf5Writer writer;
  fill(writer);
  writer.save(folder / "f.h5");
  const Hdf5Reader reader(folder / "f.h5");
  CounterRng rng(1);
  const RowMatrixXd x = reader.matrix("/bodies/cup/x");
  ASSERT_EQ(x.rows(), 101);
  for (Eigen::Index i = 0; i < x.size(); ++i) ASSERT_EQ(x.data()[i], rng.uniform(-1, 1));
  EXPECT_EQ(reader.int_matrix("/bodies/cup/T"), (RowMatrixXi{{1, 2, 3, 4}, {5, 6, 7, -8}}));
  EXPECT_EQ(reader.vector("/bodies/bowl/p"), Eigen::VectorXd(Eigen::VectorXd::LinSpaced(24, 0, 1)));
  EXPECT_EQ(reader.int_vector("/bodies/bowl/parts")(4), 4);
  EXPECT_EQ(reader.scalar("/t"), 0.1);
  EXPECT_EQ(reader.integer("/step"), std::int64_t{1} << 40);
  EXPECT_EQ(reader.text("/key"), "größe");
  EXPECT_EQ(reader.text("/empty_text"), "");
  EXPECT_EQ(reader.texts("/names"), (std::vector<std::string>{"a", "", "longer name"}));
  EXPECT_TRUE(reader.texts("/no_names").empty());
  EXPECT_EQ(reader.matrix("/nothing").cols(), 3);
  EXPECT_EQ(reader.attribute("schema_version"), 3);
  EXPECT_EQ(reader.children("/bodies"), (std::vector<std::string>{"bowl", "cup"}));
  EXPECT_TRUE(reader.has("/bodies/cup/x"));
  EXPECT_FALSE(reader.has("/bodies/jug/x"));
  EXPECT_FALSE(reader.has("/t/x"));
}

TEST(Hdf5File, SameContentGivesTheSameBytesAtAnyTime) {
  Hdf5Writer first;
  fill(first);
  const Bytes one = first.image();
  ::usleep(1'100'000);  // HDF5 keeps object times in seconds
  Hdf5Writer second;
  fill(second);
  EXPECT_EQ(one, second.image());
  EXPECT_EQ(one, second.image());
}

TEST(Hdf5File, ErrorsNameFileAndDataset) {
  const TemporaryFolder folder;
  Hdf5Writer writer;
  fill(writer);
  writer.save(folder / "f.h5");
  const Hdf5Reader reader(folder / "f.h5");
  ::testing::internal::CaptureStderr();
  const std::string missing = error_of([&] { reader.matrix("/bodies/jug/x"); });
  EXPECT_THAT(missing, HasSubstr("f.h5"));
  EXPECT_THAT(missing, HasSubstr("/bodies/jug/x is missing"));
  EXPECT_THAT(error_of([&] { reader.vector("/bodies/cup/x"); }),
              HasSubstr("/bodies/cup/x has the shape 101 by 3"));
  EXPECT_THAT(error_of([&] { reader.matrix("/t"); }), HasSubstr("/t has the shape a scalar"));
  EXPECT_THAT(error_of([&] { reader.int_matrix("/bodies/cup/x"); }), HasSubstr("another type"));
  EXPECT_THAT(error_of([&] { reader.matrix("/bodies"); }), HasSubstr("/bodies cannot be opened"));
  EXPECT_THAT(error_of([&] { reader.attribute("none"); }), HasSubstr("none"));
  EXPECT_THAT(error_of([&] { reader.children("/none"); }), HasSubstr("/none"));
  EXPECT_THAT(error_of([&] { Hdf5Reader(folder / "none.h5"); }), HasSubstr("none.h5"));
  EXPECT_THAT(error_of([&] { writer.put("/t", 1.0); }, ErrorKind::internal), HasSubstr("/t"));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << "HDF5 printed its own errors";
}

TEST(Hdf5File, EveryTruncationIsAnIoError) {
  const TemporaryFolder folder;
  Hdf5Writer writer;
  fill(writer);
  const Bytes whole = writer.image();
  ::testing::internal::CaptureStderr();
  for (std::size_t size = 0; size < whole.size(); size += size < 200 ? 1 : 251) {
    write_quickly(folder / "f.h5", {reinterpret_cast<const char*>(whole.data()), size});
    ASSERT_THAT(error_of([&] { Hdf5Reader(folder / "f.h5"); }), HasSubstr("f.h5")) << size;
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

// Damaged bytes may go unseen in the numbers themselves, but never end in anything else than an answer or an
// Error(io).
TEST(Hdf5File, DamagedBytesNeverCrash) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "HDF5 asks for absurd amounts of memory, which the sanitizer takes for an error";
#endif
  const TemporaryFolder folder;
  Hdf5Writer writer;
  fill(writer);
  const Bytes whole = writer.image();
  CounterRng rng(3);
  int errors = 0;
  for (int i = 0; i < 200; ++i) {
    Bytes bytes = whole;
    for (int k = 0; k < 8; ++k) bytes[rng.next() % bytes.size()] = static_cast<std::byte>(rng.next());
    write_quickly(folder / "f.h5", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    try {
      const Hdf5Reader reader(folder / "f.h5");
      for (const std::string& body : reader.children("/bodies")) reader.has("/bodies/" + body + "/x");
      reader.matrix("/bodies/cup/x");
      reader.int_matrix("/bodies/cup/T");
      reader.texts("/names");
      reader.integer("/step");
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::io);
      ++errors;
    }
  }
  EXPECT_GT(errors, 10);
}

}  // namespace
}  // namespace vivify
