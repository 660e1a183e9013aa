#include "common/config.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <sstream>

#include "common/text.h"

namespace vivify {
namespace {

constexpr int kMaxDepth = 100;         // of nesting; a scene has about 6
constexpr long kMaxNodes = 1'000'000;  // aliases of aliases multiply

// Turns the 0-based marks of yaml-cpp, whose columns count bytes, into 1-based lines and columns of
// characters.
class Places {
 public:
  Places(const std::string& text, std::string file) : text_(text), file_(std::move(file)) {
    line_starts_.push_back(text.starts_with("\xEF\xBB\xBF") ? 3 : 0);
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '\n') line_starts_.push_back(i + 1);
    }
  }

  Location at(const YAML::Mark& mark) const {
    if (mark.is_null()) return {file_, 0, 0};
    const auto line = static_cast<std::size_t>(std::max(mark.line, 0));
    int column = 1 + std::max(mark.column, 0);
    if (line < line_starts_.size()) {
      for (std::size_t i = line_starts_[line]; i < std::min(offset(mark), text_.size()); ++i) {
        if ((static_cast<unsigned char>(text_[i]) & 0xC0) == 0x80) --column;
      }
    }
    return {file_, mark.line + 1, std::max(column, 1)};
  }

  bool has_at(const YAML::Mark& mark, std::string_view word) const {
    const auto line = static_cast<std::size_t>(std::max(mark.line, 0));
    return line < line_starts_.size() && offset(mark) < text_.size() &&
           std::string_view(text_).substr(offset(mark)).starts_with(word);
  }

  bool line_has_leading_tab(const YAML::Mark& mark) const {
    const auto line = static_cast<std::size_t>(std::max(mark.line, 0));
    if (mark.is_null() || line >= line_starts_.size()) return false;
    const std::size_t first = text_.find_first_not_of(' ', line_starts_[line]);
    return first != std::string::npos && text_[first] == '\t';
  }

  // Whether a quoted text that begins here ends before the file does; yaml-cpp does not insist.
  bool quote_ends(const YAML::Mark& mark) const {
    const bool is_double = has_at(mark, "\"");
    if (!is_double && !has_at(mark, "'")) return true;
    for (std::size_t i = offset(mark) + 1; i < text_.size(); ++i) {
      if (is_double && text_[i] == '\\') {
        ++i;
      } else if (text_[i] == (is_double ? '"' : '\'')) {
        const bool is_pair = !is_double && i + 1 < text_.size() && text_[i + 1] == '\'';
        if (!is_pair) return true;
        ++i;
      }
    }
    return false;
  }

 private:
  std::size_t offset(const YAML::Mark& mark) const {
    return line_starts_[static_cast<std::size_t>(std::max(mark.line, 0))] +
           static_cast<std::size_t>(std::max(mark.column, 0));
  }

  const std::string& text_;
  std::string file_;
  std::vector<std::size_t> line_starts_;
};

struct Size {
  int depth = 0;
  long nodes = 0;
};

Size size_of(const ConfigNode& node) {
  Size size{1, 1};
  const auto add = [&](const ConfigNode& child) {
    const Size s = size_of(child);
    size.depth = std::max(size.depth, s.depth + 1);
    size.nodes += s.nodes;
  };
  for (const ConfigNode& item : node.items) add(item);
  for (const ConfigNode::Entry& entry : node.entries) add(entry.value);
  return size;
}

// Thrown when going on makes no sense; the problem has been added to the list already.
struct GaveUp {};

// Builds the tree from the events of the parser. yaml-cpp's own tree is not used: it hides duplicate keys and
// second documents, and a self-referencing anchor makes it a cycle.
class TreeBuilder final : public YAML::EventHandler {
 public:
  TreeBuilder(const Places& places, std::vector<Error>& errors) : places_(places), errors_(errors) {}

  ConfigNode take_root() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ < 2) return;
    if (places_.has_at(mark, "---")) {
      problem(mark, "a second document begins here",
              "a scene is one document: remove this '---' and what follows");
    } else {
      problem(mark, "unexpected text after the end of the document", "check indentation and brackets");
    }
    throw GaveUp();
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { add(ConfigNode(), mark, anchor); }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchors_.find(anchor);
    if (found == anchors_.end()) {
      problem(mark, "this alias refers to the node it stands in", "write the value out");
      add(ConfigNode(), mark, 0);
      return;
    }
    if (wants_key()) {
      problem(mark, "an alias cannot be a key", "write the key out");
      throw GaveUp();
    }
    ConfigNode copy = found->second;
    const Size size = size_of(copy);
    nodes_ += size.nodes;
    check_size(mark, size.depth);
    place(std::move(copy));
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    check_tag(mark, tag);
    ConfigNode node;
    node.quoted = tag == "!";
    if (node.quoted && !places_.quote_ends(mark)) problem(mark, "this quoted text never ends", "");
    if (!node.quoted &&
        (value.empty() || value == "~" || value == "null" || value == "Null" || value == "NULL")) {
      add(std::move(node), mark, anchor);
      return;
    }
    node.kind = ConfigNode::Kind::scalar;
    node.scalar = value;
    if (!node.quoted && !wants_key() && looks_octal(value)) {
      problem(mark, "the number " + value + " begins with 0, which some YAML readers take for octal",
              "write it without the leading zero, or in quotes when it is text");
    }
    add(std::move(node), mark, anchor);
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    start(mark, tag, anchor, ConfigNode::Kind::list);
  }
  void OnSequenceEnd() override { end(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    start(mark, tag, anchor, ConfigNode::Kind::map);
  }
  void OnMapEnd() override { end(); }

 private:
  struct Open {
    ConfigNode node;
    YAML::anchor_t anchor = 0;
    bool has_key = false;  // of a map: the key of the next value is known
    bool skip = false;     // drop the next value: its key was wrong
    std::string key;
    Location key_where;
  };

  static bool looks_octal(const std::string& text) {
    const std::size_t first = text[0] == '-' || text[0] == '+' ? 1 : 0;
    return text.size() > first + 1 && text[first] == '0' &&
           text.find_first_not_of("0123456789_", first) == std::string::npos;
  }

  bool wants_key() const {
    return !stack_.empty() && stack_.back().node.kind == ConfigNode::Kind::map && !stack_.back().has_key;
  }

  void problem(const YAML::Mark& mark, const std::string& message, const std::string& hint) {
    errors_.emplace_back(ErrorKind::usage, message, hint, places_.at(mark));
  }

  void check_size(const YAML::Mark& mark, int depth) {
    if (static_cast<int>(stack_.size()) + depth > kMaxDepth) {
      problem(mark, "nested more than " + std::to_string(kMaxDepth) + " deep", "");
      throw GaveUp();
    }
    if (nodes_ > kMaxNodes) {
      problem(mark, "more than " + std::to_string(kMaxNodes) + " values", "aliases of aliases multiply");
      throw GaveUp();
    }
  }

  void check_tag(const YAML::Mark& mark, const std::string& tag) {
    if (tag.empty() || tag == "?" || tag == "!") return;
    problem(mark, "YAML tags are not supported: " + tag, "remove the tag");
  }

  void start(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, ConfigNode::Kind kind) {
    check_tag(mark, tag);
    if (wants_key()) {
      problem(mark, "a key must be a word, not a list or map", "is a bracket left open?");
      throw GaveUp();
    }
    ++nodes_;
    check_size(mark, 1);
    Open open;
    open.node.kind = kind;
    open.node.where = places_.at(mark);
    open.anchor = anchor;
    stack_.push_back(std::move(open));
  }

  void end() {
    Open open = std::move(stack_.back());
    stack_.pop_back();
    if (open.anchor != 0) anchors_[open.anchor] = open.node;
    place(std::move(open.node));
  }

  void add(ConfigNode node, const YAML::Mark& mark, YAML::anchor_t anchor) {
    ++nodes_;
    check_size(mark, 1);
    node.where = places_.at(mark);
    if (wants_key()) {
      take_key(node, mark);
      return;
    }
    // The mark of an absent value is that of whatever comes next; its key is a better place.
    if (node.kind == ConfigNode::Kind::null && !stack_.empty() && stack_.back().has_key) {
      node.where = stack_.back().key_where;
    }
    if (anchor != 0) anchors_[anchor] = node;
    place(std::move(node));
  }

  void take_key(const ConfigNode& node, const YAML::Mark& mark) {
    Open& map = stack_.back();
    map.has_key = true;
    map.skip = true;
    map.key_where = node.where;
    if (node.kind == ConfigNode::Kind::null) {
      problem(mark, "a key is missing before ':'", "");
      return;
    }
    map.key = node.scalar;
    if (map.key == "<<" && !node.quoted) {
      problem(mark, "merge keys (<<) are not supported",
              "write the keys out, or use an alias for a whole value");
      return;
    }
    for (const ConfigNode::Entry& entry : map.node.entries) {
      if (entry.key != map.key) continue;
      problem(mark, "duplicate key '" + map.key + "'",
              "it stands at " + std::to_string(entry.key_where.line) + ":" +
                  std::to_string(entry.key_where.column) + " already");
      return;
    }
    map.skip = false;
  }

  void place(ConfigNode node) {
    if (stack_.empty()) {
      root_ = std::move(node);
      return;
    }
    Open& parent = stack_.back();
    if (parent.node.kind == ConfigNode::Kind::list) {
      parent.node.items.push_back(std::move(node));
      return;
    }
    parent.has_key = false;
    if (!parent.skip) {
      parent.node.entries.push_back({std::move(parent.key), std::move(parent.key_where), std::move(node)});
    }
  }

  const Places& places_;
  std::vector<Error>& errors_;
  ConfigNode root_;
  std::vector<Open> stack_;
  std::map<YAML::anchor_t, ConfigNode> anchors_;
  int documents_ = 0;
  long nodes_ = 0;
};

// What the parser found, in words for people who do not know the grammar of YAML.
Error syntax_error(const YAML::Exception& error, const Places& places) {
  const Location where = places.at(error.mark);
  const auto make = [&](const std::string& message, const std::string& hint) {
    return Error(ErrorKind::usage, message, hint, where);
  };
  const std::string& what = error.msg;
  if (places.line_has_leading_tab(error.mark))
    return make("a tab stands where YAML wants spaces", "indent with spaces");
  if (what == YAML::ErrorMsg::END_OF_SEQ_FLOW) return make("a '[' before this place is not closed", "");
  if (what == YAML::ErrorMsg::END_OF_MAP_FLOW) return make("a '{' before this place is not closed", "");
  if (what == YAML::ErrorMsg::FLOW_END) return make("this bracket closes nothing", "");
  if (what == YAML::ErrorMsg::MAP_VALUE) {
    return make("a ':' is not expected here",
                "check the indentation, and put text that holds ': ' in quotes");
  }
  if (what == YAML::ErrorMsg::END_OF_MAP || what == YAML::ErrorMsg::END_OF_SEQ) {
    return make("this line does not fit the ones before", "check the indentation");
  }
  if (what == YAML::ErrorMsg::UNKNOWN_TOKEN)
    return make("a text cannot begin with this character", "put it in quotes");
  return make(what, "");
}

// One step of a path such as bodies[0].material or bodies.cup.material.
std::vector<std::string> split_path(const std::string& path) {
  std::vector<std::string> steps;
  std::string step;
  const auto fail = [&] {
    throw Error(ErrorKind::usage, "--set: '" + path + "' is not a path",
                "write for example bodies.cup.scale=2");
  };
  const auto flush = [&] {
    if (step.empty()) fail();
    steps.push_back(std::move(step));
    step.clear();
  };
  bool after_bracket = false;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (path[i] == '.') {
      if (!after_bracket) flush();
      after_bracket = false;
      if (i + 1 == path.size()) fail();
    } else if (path[i] == '[') {
      if (!after_bracket) flush();
      const std::size_t close = path.find(']', i);
      if (close == std::string::npos) fail();
      step = path.substr(i + 1, close - i - 1);
      flush();
      i = close;
      after_bracket = true;
    } else {
      if (after_bracket) fail();
      step += path[i];
    }
  }
  if (!after_bracket) flush();
  return steps;
}

std::optional<std::size_t> as_index(const std::string& step) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(step.data(), step.data() + step.size(), index);
  if (error != std::errc() || end != step.data() + step.size()) return std::nullopt;
  return index;
}

void set_places(ConfigNode& node, const Location& where) {
  node.where = where;
  for (ConfigNode& item : node.items) set_places(item, where);
  for (ConfigNode::Entry& entry : node.entries) {
    entry.key_where = where;
    set_places(entry.value, where);
  }
}

ConfigNode& child_of_list(ConfigNode& list, const std::string& step, const std::string& so_far) {
  if (const std::optional<std::size_t> index = as_index(step)) {
    if (*index < list.items.size()) return list.items[*index];
    throw Error(ErrorKind::usage,
                "--set: " + so_far + " has " + std::to_string(list.items.size()) +
                    " items, there is none with index " + step,
                "indices count from 0");
  }
  std::vector<std::string> names;
  for (ConfigNode& item : list.items) {
    for (const ConfigNode::Entry& entry : item.entries) {
      if (entry.key != "name") continue;
      if (entry.value.scalar == step) return item;
      names.push_back(entry.value.scalar);
    }
  }
  throw Error(ErrorKind::usage, "--set: nothing in " + so_far + " is called '" + step + "'",
              names.empty() ? "use an index, counted from 0" : "known names: " + join_words(names));
}

ConfigNode& child_of_map(ConfigNode& map, const std::string& step, const Location& where) {
  for (ConfigNode::Entry& entry : map.entries) {
    if (entry.key == step) return entry.value;
  }
  map.entries.push_back({step, where, ConfigNode()});
  map.entries.back().value.where = where;
  return map.entries.back().value;
}

}  // namespace

ConfigNode parse_yaml(const std::string& text, const std::string& file_name, std::vector<Error>& errors) {
  const Places places(text, file_name);
  TreeBuilder builder(places, errors);
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& error) {
    errors.push_back(syntax_error(error, places));
    return {};
  } catch (const GaveUp&) {
    return {};
  }
  ConfigNode root = builder.take_root();
  if (root.where.line == 0) root.where = {file_name, 1, 1};  // an empty file
  return root;
}

void apply_override(ConfigNode& root, const std::string& assignment) {
  const Location where{"--set", 0, 0};
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) {
    throw Error(ErrorKind::usage, "--set: '" + assignment + "' has no '='", "write --set path.to.key=value");
  }
  std::string path = assignment.substr(0, equals);
  while (!path.empty() && path.back() == ' ') path.pop_back();

  std::vector<Error> errors;
  ConfigNode value = parse_yaml(assignment.substr(equals + 1), "--set", errors);
  if (!errors.empty()) {
    throw Error(ErrorKind::usage, "--set " + path + ": " + errors.front().what(), errors.front().hint());
  }
  set_places(value, where);

  ConfigNode* node = &root;
  std::string so_far;
  for (const std::string& step : split_path(path)) {
    if (node->kind == ConfigNode::Kind::null) {
      if (!so_far.empty() && step.find_first_not_of("0123456789") == step.npos) {
        throw Error(ErrorKind::usage, "--set: " + so_far + " is no list in the file that has a part " + step,
                    "give the whole list: --set '" + so_far + "=[...]'");
      }
      node->kind = ConfigNode::Kind::map;
      node->where = where;
    }
    if (node->kind == ConfigNode::Kind::list) {
      node = &child_of_list(*node, step, so_far);
    } else if (node->kind == ConfigNode::Kind::map) {
      node = &child_of_map(*node, step, where);
    } else {
      throw Error(ErrorKind::usage,
                  "--set: " + so_far + " is '" + node->scalar + "' and has no key '" + step + "'");
    }
    so_far += (so_far.empty() ? "" : ".") + step;
  }
  *node = std::move(value);
}

}  // namespace vivify
