#include "meshing/glyph.h"

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H

#include <memory>

#include "common/error.h"
#include "common/file.h"

namespace vivify::meshing {
namespace {

std::string code_text(char32_t code) {
  constexpr char kDigits[] = "0123456789ABCDEF";
  std::string text;
  for (int shift = code > 0xFFFF ? 20 : 12; shift >= 0; shift -= 4) text += kDigits[(code >> shift) & 15];
  return "U+" + text;
}

struct Character {
  char32_t code;
  std::string bytes;
};

std::vector<Character> characters_of(const std::string& text) {
  std::vector<Character> characters;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const int size = lead < 0x80 ? 1 : lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : lead >= 0xC2 ? 2 : 0;
    char32_t code = size == 1 ? lead : lead & (0x7FU >> size);
    bool valid = size > 0 && i + static_cast<std::size_t>(size) <= text.size();
    for (int k = 1; valid && k < size; ++k) {
      const auto byte = static_cast<unsigned char>(text[i + static_cast<std::size_t>(k)]);
      valid = (byte & 0xC0) == 0x80;
      code = code << 6 | (byte & 0x3F);
    }
    if (!valid) {
      throw Error(ErrorKind::usage, "the text of a glyph is not UTF-8 at byte " + std::to_string(i + 1),
                  "save the scene file as UTF-8");
    }
    characters.push_back({code, text.substr(i, static_cast<std::size_t>(size))});
    i += static_cast<std::size_t>(size);
  }
  return characters;
}

struct Sink {
  std::vector<CurveContour> contours;
  double shift = 0;

  Eigen::Vector2d at(const FT_Vector* p) const {
    return {static_cast<double>(p->x) + shift, static_cast<double>(p->y)};
  }
};

// Callbacks of FT_Outline_Decompose.
Sink& sink_of(void* user) { return *static_cast<Sink*>(user); }
int move_to(const FT_Vector* to, void* user) {
  sink_of(user).contours.emplace_back(sink_of(user).at(to));
  sink_of(user).contours.back().close();
  return 0;
}
int line_to(const FT_Vector* to, void* user) {
  sink_of(user).contours.back().line_to(sink_of(user).at(to));
  return 0;
}
int conic_to(const FT_Vector* control, const FT_Vector* to, void* user) {
  sink_of(user).contours.back().quadratic_to(sink_of(user).at(control), sink_of(user).at(to));
  return 0;
}
int cubic_to(const FT_Vector* a, const FT_Vector* b, const FT_Vector* to, void* user) {
  const Sink& sink = sink_of(user);
  sink_of(user).contours.back().cubic_to(sink.at(a), sink.at(b), sink.at(to));
  return 0;
}

}  // namespace

std::vector<CurveContour> glyph_contours(const std::filesystem::path& font, const std::string& text) {
  const std::vector<Character> characters = characters_of(text);
  const Bytes bytes = read_file(font);
  FT_Library library_handle = nullptr;
  if (FT_Init_FreeType(&library_handle) != 0) throw Error(ErrorKind::internal, "FreeType does not start");
  const std::unique_ptr<FT_LibraryRec_, decltype(&FT_Done_FreeType)> library(library_handle,
                                                                             &FT_Done_FreeType);
  FT_Face face_handle = nullptr;
  if (FT_New_Memory_Face(library.get(), reinterpret_cast<const FT_Byte*>(bytes.data()),
                         static_cast<FT_Long>(bytes.size()), 0, &face_handle) != 0) {
    throw Error(ErrorKind::geometry, font.string() + " is not a font that can be read",
                "give a TrueType or OpenType file");
  }
  const std::unique_ptr<FT_FaceRec_, decltype(&FT_Done_Face)> face(face_handle, &FT_Done_Face);
  if (!FT_IS_SCALABLE(face.get())) {
    throw Error(ErrorKind::geometry, font.string() + " is a font of pixels, not of outlines",
                "give a TrueType or OpenType file");
  }
  Sink sink;
  const FT_Outline_Funcs callbacks = {move_to, line_to, conic_to, cubic_to, 0, 0};
  for (const Character& character : characters) {
    const FT_UInt index = FT_Get_Char_Index(face.get(), character.code);
    if (index == 0) {
      throw Error(
          ErrorKind::geometry,
          font.string() + " has no glyph for '" + character.bytes + "' (" + code_text(character.code) + ")",
          "choose another character or another font");
    }
    if (FT_Load_Glyph(face.get(), index, FT_LOAD_NO_SCALE | FT_LOAD_NO_BITMAP) != 0 ||
        face->glyph->format != FT_GLYPH_FORMAT_OUTLINE ||
        FT_Outline_Decompose(&face->glyph->outline, &callbacks, &sink) != 0) {
      throw Error(ErrorKind::geometry,
                  font.string() + " cannot draw '" + character.bytes + "' (" + code_text(character.code) +
                      ") as an outline",
                  "choose another font");
    }
    sink.shift += static_cast<double>(face->glyph->metrics.horiAdvance);
  }
  if (sink.contours.empty()) {
    throw Error(ErrorKind::geometry, "the text '" + text + "' draws nothing in " + font.string(),
                "give a character with an outline");
  }
  return std::move(sink.contours);
}

}  // namespace vivify::meshing
