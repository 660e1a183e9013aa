#include "render/film.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <string>

#include "common/error.h"

namespace vivify::render {
namespace {

constexpr float kHalfMax = 65504;

class MemoryOutput : public Imf::OStream {
 public:
  MemoryOutput() : OStream("film in memory") {}
  void write(const char data[], int n) override {
    const auto end = position_ + static_cast<std::size_t>(n);
    if (bytes_.size() < end) bytes_.resize(end);
    std::memcpy(bytes_.data() + position_, data, static_cast<std::size_t>(n));
    position_ = end;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }
  Bytes take() { return std::move(bytes_); }

 private:
  Bytes bytes_;
  std::size_t position_ = 0;
};

class MemoryInput : public Imf::IStream {
 public:
  explicit MemoryInput(const Bytes& bytes) : IStream("film in memory"), bytes_(bytes) {}
  bool read(char data[], int n) override {
    if (position_ + static_cast<std::size_t>(n) > bytes_.size())
      throw std::runtime_error("the file ends too early");
    std::memcpy(data, bytes_.data() + position_, static_cast<std::size_t>(n));
    position_ += static_cast<std::size_t>(n);
    return position_ < bytes_.size();
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override { position_ = position; }

 private:
  const Bytes& bytes_;
  std::size_t position_ = 0;
};

// A channel of the file and its place in a plane of the film.
struct Channel {
  const char* name;
  Imf::PixelType type;
  std::vector<float> Film::*plane;
  int offset;
  int stride;  // floats per pixel of the plane
};
constexpr Channel kChannels[] = {
    {"R", Imf::HALF, &Film::rgba, 0, 4},           {"G", Imf::HALF, &Film::rgba, 1, 4},
    {"B", Imf::HALF, &Film::rgba, 2, 4},           {"A", Imf::HALF, &Film::rgba, 3, 4},
    {"albedo.R", Imf::HALF, &Film::albedo, 0, 3},  {"albedo.G", Imf::HALF, &Film::albedo, 1, 3},
    {"albedo.B", Imf::HALF, &Film::albedo, 2, 3},  {"normal.X", Imf::FLOAT, &Film::normal, 0, 3},
    {"normal.Y", Imf::FLOAT, &Film::normal, 1, 3}, {"normal.Z", Imf::FLOAT, &Film::normal, 2, 3},
    {"depth.Z", Imf::FLOAT, &Film::depth, 0, 1},   {"id.ID", Imf::FLOAT, &Film::id, 0, 1}};

}  // namespace

Film::Film(int film_width, int film_height)
    : width(film_width),
      height(film_height),
      rgba(4 * pixels()),
      albedo(3 * pixels()),
      normal(3 * pixels()),
      depth(pixels()),
      id(pixels()) {}

Bytes encode_exr(const Film& film) {
  try {
    Imf::Header header(film.width, film.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::addChromaticities(header, Imf::Chromaticities());  // the default is Rec. 709
    Imf::FrameBuffer buffer;
    std::vector<std::vector<half>> halves;
    halves.reserve(std::size(kChannels));
    for (const Channel& channel : kChannels) {
      const std::vector<float>& plane = film.*channel.plane;
      const auto stride = static_cast<std::size_t>(channel.stride);
      if (plane.size() != stride * film.pixels()) {
        throw Error(ErrorKind::internal,
                    std::string("the film's plane of ") + channel.name + " has a wrong size");
      }
      header.channels().insert(channel.name, Imf::Channel(channel.type));
      if (channel.type == Imf::HALF) {
        std::vector<half>& values = halves.emplace_back(film.pixels());
        for (std::size_t i = 0; i < values.size(); ++i) {
          values[i] =
              std::clamp(plane[stride * i + static_cast<std::size_t>(channel.offset)], -kHalfMax, kHalfMax);
        }
        buffer.insert(channel.name,
                      Imf::Slice(Imf::HALF, reinterpret_cast<char*>(values.data()), sizeof(half),
                                 sizeof(half) * static_cast<std::size_t>(film.width)));
      } else {
        auto* first = const_cast<float*>(plane.data() + channel.offset);  // Imf reads it only
        buffer.insert(channel.name,
                      Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(first), stride * sizeof(float),
                                 stride * sizeof(float) * static_cast<std::size_t>(film.width)));
      }
    }
    MemoryOutput output;
    {
      Imf::OutputFile file(output, header, 0);
      file.setFrameBuffer(buffer);
      file.writePixels(film.height);
    }
    return output.take();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    throw Error(ErrorKind::internal, std::string("the film cannot be encoded: ") + e.what());
  }
}

Film decode_exr(const Bytes& bytes) {
  try {
    MemoryInput input(bytes);
    Imf::InputFile file(input, 0);
    const Imath::Box2i window = file.header().dataWindow();
    Film film(window.max.x - window.min.x + 1, window.max.y - window.min.y + 1);
    Imf::FrameBuffer buffer;
    for (const Channel& channel : kChannels) {
      if (file.header().channels().findChannel(channel.name) == nullptr) {
        throw std::runtime_error(std::string("the channel ") + channel.name + " is missing");
      }
      const auto stride = static_cast<std::size_t>(channel.stride) * sizeof(float);
      float* first = (film.*channel.plane).data() + channel.offset;
      char* base = reinterpret_cast<char*>(first) -
                   static_cast<std::ptrdiff_t>(stride) *
                       (window.min.x + static_cast<std::ptrdiff_t>(window.min.y) * film.width);
      buffer.insert(channel.name,
                    Imf::Slice(Imf::FLOAT, base, stride, stride * static_cast<std::size_t>(film.width)));
    }
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
    return film;
  } catch (const std::exception& e) {
    throw Error(ErrorKind::io, std::string("not a film of vivify: ") + e.what());
  }
}

}  // namespace vivify::render
