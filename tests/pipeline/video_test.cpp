#include "pipeline/video.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "common/error.h"
#include "common/file.h"
#include "common/stop.h"
#include "pipeline/child_process.h"
#include "render/view_transform.h"
#include "tests/render/test_images.h"

namespace vivify::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

// Calls `on_advance` after every frame.
class Observer : public Progress {
 public:
  explicit Observer(std::function<void(long)> on_advance = {}) : on_advance_(std::move(on_advance)) {}
  void start(const std::string&, long, long) override {}
  void advance(long units, const std::string&) override {
    done += units;
    if (on_advance_) on_advance_(done);
  }
  void finish() override {}
  long done = 0;

 private:
  std::function<void(long)> on_advance_;
};

class VideoTest : public testing::Test {
 protected:
  VideoTest() { fs::create_directory(frames_folder()); }
  ~VideoTest() override {
    ::setenv("PATH", path_.c_str(), 1);
    fs::remove_all(bin());
  }

  fs::path frames_folder() const { return folder_ / "render"; }
  fs::path output() const { return folder_ / "clip.mp4"; }
  fs::path bin() const { return folder_.path().string() + "_bin"; }

  // Flat grey frames that become brighter.
  std::vector<fs::path> grey_frames(int count, int width = 32, int height = 18) const {
    std::vector<fs::path> frames;
    for (int i = 0; i < count; ++i) {
      frames.push_back(frames_folder() / ("clip." + std::to_string(1001 + i) + ".exr"));
      const float light = 0.02f * static_cast<float>(i + 1);
      test::write_flat_exr(frames.back(), width, height, light, light, light);
    }
    return frames;
  }

  // Noisy frames: their video is not small.
  std::vector<fs::path> noisy_frames(int count) const {
    std::vector<fs::path> frames;
    for (int i = 0; i < count; ++i) {
      frames.push_back(frames_folder() / ("noise." + std::to_string(1001 + i) + ".exr"));
      render::Image image{160, 90, {"R", "G", "B"}, {}, false};
      CounterRng rng(static_cast<std::uint64_t>(i));
      for (int k = 0; k < 160 * 90 * 3; ++k) image.values.push_back(static_cast<float>(rng.uniform()));
      test::write_exr(frames.back(), image);
    }
    return frames;
  }

  // Names of everything in the folder.
  std::vector<std::string> names() const {
    std::vector<std::string> result;
    for (const auto& entry : fs::directory_iterator(folder_.path()))
      result.push_back(entry.path().filename());
    std::ranges::sort(result);
    return result;
  }
  // Nothing but the frames is in the folder.
  void expect_nothing_left() const { EXPECT_THAT(names(), testing::ElementsAre("render")); }

  // Puts a shell script called ffmpeg first on the PATH.
  void fake_ffmpeg(const std::string& script) {
    fs::create_directory(bin());
    std::ofstream(bin() / "ffmpeg") << "#!/bin/sh\n" << script << "\n";
    ::chmod((bin() / "ffmpeg").c_str(), 0755);
    ::setenv("PATH", (bin().string() + ":" + path_).c_str(), 1);
  }

  // The full text of the Error(io) of an encoding.
  static std::string failure(const std::vector<fs::path>& frames, const fs::path& output,
                             Progress* progress = nullptr) {
    try {
      encode_video(frames, output, {}, progress);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::io) << error.what();
      return error.full_text();
    }
    ADD_FAILURE() << "no error";
    return {};
  }

  // What ffprobe says about the video stream, as key=value lines.
  static std::string probe(const fs::path& file, const std::string& entries) {
    ChildProcess child(find_program("ffprobe"),
                       {"-v", "error", "-count_frames", "-select_streams", "v", "-show_entries", entries,
                        "-of", "default=noprint_wrappers=1", file.string()});
    return child.finish().output;
  }

  // The pixels of frame `index` as 8-bit RGB.
  static std::string decoded(const fs::path& file, int index) {
    ChildProcess child(find_program("ffmpeg"),
                       {"-v", "error", "-i", file.string(), "-vf",
                        "select=eq(n\\," + std::to_string(index) +
                            "),scale=in_color_matrix=bt709:in_range=tv:"
                            "flags=accurate_rnd+full_chroma_int",
                        "-frames:v", "1", "-pix_fmt", "rgb24", "-f", "rawvideo", "-"});
    return child.finish().output;
  }

  test::Folder folder_;

 private:
  std::string path_ = std::getenv("PATH");
};

TEST_F(VideoTest, HoldsEveryFrameAtTheRightRateWithTheRightTags) {
  Observer observer;
  encode_video(grey_frames(12), output(), {.rate = {24, 1}}, &observer);
  EXPECT_EQ(observer.done, 12);
  const std::string text =
      probe(output(),
            "stream=codec_name,width,height,pix_fmt,r_frame_rate,avg_frame_rate,nb_read_frames,"
            "color_range,color_space,color_transfer,color_primaries:format=duration:format_tags");
  for (const char* line : {"codec_name=h264", "width=32", "height=18", "pix_fmt=yuv420p", "r_frame_rate=24/1",
                           "avg_frame_rate=24/1", "nb_read_frames=12", "duration=0.500000", "color_range=tv",
                           "color_space=bt709", "color_transfer=bt709", "color_primaries=bt709"}) {
    EXPECT_THAT(text, HasSubstr(std::string(line) + "\n"));
  }
  for (const char* word : {"creation_time", "encoder"}) EXPECT_THAT(text, Not(HasSubstr(word)));
  EXPECT_THAT(names(), testing::ElementsAre("clip.mp4", "render"));
}

TEST_F(VideoTest, RatesMayBeFractions) {
  encode_video(grey_frames(6), output(), {.rate = {24000, 1001}});
  const std::string text = probe(output(), "stream=avg_frame_rate,nb_read_frames:format=duration");
  EXPECT_THAT(text, HasSubstr("avg_frame_rate=24000/1001\n"));
  EXPECT_THAT(text, HasSubstr("nb_read_frames=6\n"));
}

TEST_F(VideoTest, OneFrameIsAVideo) {
  encode_video(grey_frames(1), output());
  EXPECT_THAT(probe(output(), "stream=nb_read_frames"), HasSubstr("nb_read_frames=1\n"));
}

TEST_F(VideoTest, TheSameFramesGiveTheSameBytes) {
  const std::vector<fs::path> frames = noisy_frames(5);
  encode_video(frames, output());
  const Bytes first = read_file(output());
  encode_video(frames, folder_ / "again.mp4");
  EXPECT_EQ(first, read_file(folder_ / "again.mp4"));
  const fs::path moov_first =
      output();  // +faststart: the index is in front, so that a browser can start at once
  const std::string head(reinterpret_cast<const char*>(first.data()), 64);
  EXPECT_NE(head.find("moov"), std::string::npos);
}

TEST_F(VideoTest, ColoursSurviveAndFramesAreInOrder) {
  const std::vector<fs::path> frames = grey_frames(6);
  encode_video(frames, output(), {.rate = {}, .exposure_stops = 1});
  for (int i = 0; i < 6; ++i) {
    const float light = 0.02f * static_cast<float>(i + 1);
    const std::vector<float> grey{light, light, light};
    const int expected = render::ViewTransform(render::Display::rec709, 1).pixels(grey)[0];
    const std::string pixels = decoded(output(), i);
    ASSERT_EQ(pixels.size(), 32u * 18 * 3) << pixels;
    for (const char value : pixels) ASSERT_NEAR(static_cast<unsigned char>(value), expected, 2) << i;
  }
}

// A wrong matrix (bt601) or range moves these colours by 8 and more.
TEST_F(VideoTest, SaturatedColoursSurvive) {
  const std::vector<std::array<float, 3>> colors{
      {0.6f, 0.05f, 0.05f}, {0.05f, 0.4f, 0.05f}, {0.05f, 0.1f, 0.7f}, {0.7f, 0.6f, 0.05f}};
  std::vector<fs::path> frames;
  for (const auto& [r, g, b] : colors) {
    frames.push_back(frames_folder() / ("c." + std::to_string(frames.size()) + ".exr"));
    test::write_flat_exr(frames.back(), 32, 18, r, g, b);
  }
  encode_video(frames, output(), {.rate = {}, .crf = 4});
  const render::ViewTransform view(render::Display::rec709);
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const std::vector<std::uint8_t> expected = view.pixels(colors[i]);
    const std::string pixels = decoded(output(), static_cast<int>(i));
    ASSERT_EQ(pixels.size(), 32u * 18 * 3) << pixels;
    for (std::size_t k = 0; k < pixels.size(); ++k) {
      ASSERT_NEAR(static_cast<unsigned char>(pixels[k]), expected[k % 3], 3) << i << " " << k;
    }
  }
}

TEST_F(VideoTest, OddSizesArePaddedByRepeatingTheEdge) {
  encode_video(grey_frames(3, 33, 17), output());
  const std::string text = probe(output(), "stream=width,height,nb_read_frames");
  EXPECT_THAT(text, HasSubstr("width=34\nheight=18\n"));
  EXPECT_THAT(text, HasSubstr("nb_read_frames=3\n"));
  const std::string pixels = decoded(output(), 2);
  ASSERT_EQ(pixels.size(), 34u * 18 * 3);
  for (const char value : pixels) {
    ASSERT_NEAR(static_cast<unsigned char>(value), static_cast<unsigned char>(pixels[0]), 2);
  }
}

TEST_F(VideoTest, WithoutFfmpegTheFramesAreKept) {
  const std::vector<fs::path> frames = grey_frames(2);
  ::setenv("PATH", "", 1);
  const std::string text = failure(frames, output());
  EXPECT_THAT(text,
              HasSubstr("ffmpeg is not on the PATH; the frames are kept in " + frames_folder().string()));
  EXPECT_THAT(text, HasSubstr("vivify encode"));
  EXPECT_THROW(require_ffmpeg(frames_folder()), Error);
  expect_nothing_left();
  for (const fs::path& frame : frames) EXPECT_TRUE(fs::exists(frame));
}

TEST_F(VideoTest, AFailingFfmpegIsQuoted) {
  const std::vector<fs::path> frames = noisy_frames(20);
  fake_ffmpeg(
      "for last; do :; done; echo half > \"${last#file:}\"; head -c 1000 > /dev/null; echo 'out of ink' >&2; "
      "exit 3");
  const std::string text = failure(frames, output());
  EXPECT_THAT(text, HasSubstr("ffmpeg ended with code 3"));
  EXPECT_THAT(text, HasSubstr("out of ink"));
  EXPECT_THAT(text, HasSubstr(output().string()));
  EXPECT_THAT(text, HasSubstr("the frames are kept in"));
  expect_nothing_left();
}

TEST_F(VideoTest, AnFfmpegThatStopsReadingIsAFailure) {
  const std::vector<fs::path> frames = noisy_frames(20);
  fake_ffmpeg("exit 0");
  EXPECT_THAT(failure(frames, output()), HasSubstr("ffmpeg"));
  expect_nothing_left();
}

TEST_F(VideoTest, AnFfmpegThatWritesNothingIsAFailure) {
  fake_ffmpeg("cat > /dev/null");
  EXPECT_THAT(failure(grey_frames(2), output()), HasSubstr("ffmpeg did not write"));
  expect_nothing_left();
}

TEST_F(VideoTest, AVideoThatLacksFramesIsAFailure) {
  const std::string real = find_program("ffmpeg").string();
  fake_ffmpeg("{ head -c " + std::to_string(3 * 32 * 18 * 3) + "; cat > /dev/null; } | " + real + " \"$@\"");
  const std::string text = failure(grey_frames(5), output());
  EXPECT_THAT(text, HasSubstr("whole (3 of 5 frames)"));
  expect_nothing_left();
}

TEST_F(VideoTest, AKilledFfmpegLeavesNothing) {
  Observer observer([](long done) {
    if (done != 2) return;
    std::ifstream children("/proc/self/task/" + std::to_string(::getpid()) + "/children");
    int pid = 0;
    ASSERT_TRUE(children >> pid);
    ASSERT_EQ(::kill(pid, SIGKILL), 0);
  });
  EXPECT_THAT(failure(noisy_frames(20), output(), &observer), HasSubstr("was killed by signal 9"));
  EXPECT_LT(observer.done, 20);
  expect_nothing_left();
}

// A full disk, both ways a program may meet it: killed by SIGXFSZ, or told by the failing write when the
// signal is ignored. ffmpeg itself ends with code 0 in some of these cases.
TEST_F(VideoTest, AShortWriteLeavesNothing) {
  const std::vector<fs::path> frames = noisy_frames(8);
  encode_video(frames, output());
  const rlim_t whole = fs::file_size(output());
  ASSERT_GT(whole, 40000u);
  fs::remove(output());
  rlimit before = {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  for (const auto handler : {SIG_DFL, SIG_IGN}) {
    for (const rlim_t limit : {rlim_t{0}, rlim_t{100}, whole / 2, whole - 100, whole - 1}) {
      const auto old_handler = std::signal(SIGXFSZ, handler);
      const rlimit small = {limit, before.rlim_max};
      ::setrlimit(RLIMIT_FSIZE, &small);
      const std::string text = failure(frames, output());
      ::setrlimit(RLIMIT_FSIZE, &before);
      std::signal(SIGXFSZ, old_handler);
      EXPECT_THAT(text, testing::AnyOf(HasSubstr("File too large"), HasSubstr("File size limit exceeded")))
          << limit << " of " << whole;
      expect_nothing_left();
    }
  }
}

TEST_F(VideoTest, ARequestedStopLeavesNothing) {
  GTEST_FLAG_SET(death_test_style,
                 "threadsafe");  // the stop flag cannot be taken back: in a process of its own
  const auto stopped = [&] {
    install_stop_handlers();
    Observer observer([](long done) {
      if (done == 3) ::raise(SIGTERM);
    });
    int code = 0;
    try {
      encode_video(noisy_frames(20), output(), {}, &observer);
    } catch (const Error& error) {
      code = exit_code(error.kind());
    }
    const bool clean = names() == std::vector<std::string>{"render"};
    fs::remove_all(folder_.path());
    std::exit(observer.done == 3 && clean ? code : 1);
  };
  EXPECT_EXIT(stopped(), testing::ExitedWithCode(75), "");
}

TEST_F(VideoTest, AFailureKeepsTheVideoOfBefore) {
  encode_video(grey_frames(2), output());
  const Bytes before = read_file(output());
  fake_ffmpeg("exit 1");
  failure(noisy_frames(3), output());
  EXPECT_EQ(before, read_file(output()));
}

TEST_F(VideoTest, AFolderThatIsNotThereIsAnError) {
  EXPECT_THAT(failure(grey_frames(2), folder_ / "none/clip.mp4"), HasSubstr("No such file or directory"));
  EXPECT_THAT(failure({}, output()), HasSubstr("no frames"));
  expect_nothing_left();
}

TEST_F(VideoTest, WrongFramesAreNamed) {
  std::vector<fs::path> frames = grey_frames(3);
  test::write_flat_exr(frames[1], 16, 18, 1, 1, 1);
  EXPECT_THAT(failure(frames, output()), HasSubstr("clip.1002.exr is 16x18, but the first frame is 32x18"));
  fs::remove(frames[1]);
  EXPECT_THAT(failure(frames, output()), HasSubstr("clip.1002.exr: no such file"));
  expect_nothing_left();
}

}  // namespace
}  // namespace vivify::pipeline
