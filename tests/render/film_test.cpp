#include "render/film.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include "common/error.h"
#include "common/rng.h"
#include "tests/common/temporary_folder.h"

namespace vivify::render {
namespace {

using vivify::testing_support::TemporaryFolder;

Film random_film(int width, int height) {
  Film film(width, height);
  CounterRng rng(1);
  for (auto* plane : {&film.rgba, &film.albedo, &film.normal, &film.depth, &film.id}) {
    for (float& v : *plane) v = static_cast<float>(rng.uniform(-1, 4));
  }
  return film;
}

void expect_near(const std::vector<float>& a, const std::vector<float>& b, float relative) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    EXPECT_NEAR(a[i], b[i], relative * std::abs(b[i]) + relative * 1e-3f);
}

TEST(Film, ReadsBackThroughOpenImageIO) {
  const TemporaryFolder folder;
  const Film film = random_film(37, 19);
  const auto path = folder.path() / "film.exr";
  write_file_atomic(path, encode_exr(film));
  const auto input = OIIO::ImageInput::open(path.string());
  ASSERT_TRUE(input) << OIIO::geterror();
  const OIIO::ImageSpec& spec = input->spec();
  EXPECT_EQ(spec.width, 37);
  EXPECT_EQ(spec.height, 19);
  EXPECT_EQ(spec.find_attribute("DateTime"), nullptr);
  EXPECT_NE(spec.find_attribute("chromaticities"), nullptr);
  EXPECT_EQ(spec.get_string_attribute("compression"), "zip");
  std::vector<float> values(film.pixels() * static_cast<std::size_t>(spec.nchannels));
  ASSERT_TRUE(input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data()));
  const auto channel = [&](const std::string& name) {
    std::vector<float> plane;
    for (int c = 0; c < spec.nchannels; ++c) {
      if (spec.channelnames[static_cast<std::size_t>(c)] != name) continue;
      for (std::size_t i = 0; i < film.pixels(); ++i) {
        plane.push_back(values[i * static_cast<std::size_t>(spec.nchannels) + static_cast<std::size_t>(c)]);
      }
    }
    return plane;
  };
  const auto plane = [&](const std::vector<float>& all, std::size_t stride, std::size_t offset) {
    std::vector<float> one;
    for (std::size_t i = 0; i < film.pixels(); ++i) one.push_back(all[stride * i + offset]);
    return one;
  };
  constexpr float kHalf = 0x1p-10f;
  expect_near(channel("R"), plane(film.rgba, 4, 0), kHalf);
  expect_near(channel("A"), plane(film.rgba, 4, 3), kHalf);
  expect_near(channel("albedo.G"), plane(film.albedo, 3, 1), kHalf);
  expect_near(channel("normal.Z"), plane(film.normal, 3, 2), 0);
  EXPECT_EQ(channel("depth.Z"), film.depth);
  EXPECT_EQ(channel("id.ID"), film.id);
}

TEST(Film, DecodesWhatItEncodes) {
  const Film film = random_film(20, 33);
  const Bytes bytes = encode_exr(film);
  EXPECT_EQ(bytes, encode_exr(film));  // the same film, the same bytes
  const Film again = decode_exr(bytes);
  EXPECT_EQ(again.width, 20);
  expect_near(again.rgba, film.rgba, 0x1p-10f);
  EXPECT_EQ(again.normal, film.normal);
  EXPECT_EQ(encode_exr(again), bytes);
}

TEST(Film, ClampsToTheRangeOfHalf) {
  Film film(2, 1);
  film.rgba[0] = 1e9f;
  EXPECT_EQ(decode_exr(encode_exr(film)).rgba[0], 65504);
}

TEST(Film, RefusesDamage) {
  Film film = random_film(8, 8);
  Bytes bytes = encode_exr(film);
  bytes.resize(bytes.size() / 2);
  EXPECT_THROW(decode_exr(bytes), Error);
  film.depth.pop_back();
  EXPECT_THROW(encode_exr(film), Error);
}

}  // namespace
}  // namespace vivify::render
