// The example of docs/extending.md: it builds, it conforms, and the document shows the very files.
#include <fstream>
#include <regex>
#include <sstream>

#include "tests/sim/conformance.h"
#include "tests/sim/extending/membrane3d.h"
#include "tests/sim/extending/squared_area.h"
#include "tests/sim/extending/uniform_scale.h"

namespace vivify::sim {
namespace {

constexpr ModelEntry kModels[] = {kMembrane3d};
constexpr RestSpaceEntry kSpaces[] = {kUniformScale};

std::vector<BodyCase> joined(std::vector<BodyCase> a, const std::vector<BodyCase>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

INSTANTIATE_TEST_SUITE_P(Extension, MeasureConformance, ::testing::Values(kSquaredArea), measure_name);
INSTANTIATE_TEST_SUITE_P(Extension, ModelConformance, ::testing::ValuesIn(model_cases(kModels)), model_name);
// A membrane without bending does not feel every fold of a cage, but every example.
const RestSpaceEntry kExamples[] = {rest_space_entry("examples")};
INSTANTIATE_TEST_SUITE_P(Extension, RestSpaceConformance,
                         ::testing::ValuesIn(joined(body_cases(elastic_models(), kSpaces),
                                                    joined(body_cases(kModels, kSpaces),
                                                           body_cases(kModels, kExamples)))),
                         case_name);
INSTANTIATE_TEST_SUITE_P(Extension, StepConformance,
                         ::testing::ValuesIn(joined(body_cases(elastic_models(), kSpaces),
                                                    joined(body_cases(kModels, kSpaces),
                                                           body_cases(kModels, rest_spaces())))),
                         case_name);

std::string text_of(const std::string& path) {
  std::ifstream file(std::string(VIVIFY_SOURCE_DIR) + "/" + path);
  EXPECT_TRUE(file) << path;
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(Extending, TheDocumentQuotesTheFiles) {
  const std::string document = text_of("docs/extending.md");
  for (const char* name : {"squared_area.h", "membrane3d.h", "uniform_scale.h"}) {
    const std::string path = std::string("tests/sim/extending/") + name;
    const std::string block = "`" + path + "`:\n\n```cpp\n" + text_of(path) + "```\n";
    EXPECT_NE(document.find(block), std::string::npos)
        << "docs/extending.md must show " << path << " word by word";
  }
}

// Every file of the tree that the document names is there.
TEST(Extending, TheDocumentNamesFilesThatExist) {
  const std::string document = text_of("docs/extending.md");
  const std::regex path("`((?:sim|tests|docs)/[a-z0-9_/]+\\.(?:h|cpp|md|txt))`");
  int found = 0;
  for (std::sregex_iterator it(document.begin(), document.end(), path), end; it != end; ++it, ++found) {
    EXPECT_TRUE(std::ifstream(std::string(VIVIFY_SOURCE_DIR) + "/" + (*it)[1].str())) << (*it)[1];
  }
  EXPECT_GE(found, 10);
}

}  // namespace
}  // namespace vivify::sim
