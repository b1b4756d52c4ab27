#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/fuzz/entries.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::fuzz;

namespace {

struct Target {
    std::string corpus;
    void (*entry)(Bytes);
};

std::vector<std::filesystem::path> files_of(const std::string& corpus) {
    std::vector<std::filesystem::path> files;
    const std::filesystem::path folder =
        std::filesystem::path(PALPATE_SOURCE_DIR) / "tests/fuzz/corpus" / corpus;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
}

std::vector<std::uint8_t> bytes_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

TEST_CASE("what the fuzzers were fed and found is read without harm", "[fuzz][law]") {
    const Target target = GENERATE(Target{"geometry", feel_geometry}, Target{"scene", read_scene},
                                   Target{"csv", read_csv}, Target{"protocol", read_protocol});
    const auto files = files_of(target.corpus);
    CHECK(files.size() >= 3);
    for (const auto& file : files) {
        INFO(file.string());  // a breach ends the program: the last name printed is the culprit's
        std::vector<std::uint8_t> bytes = bytes_of(file);
        target.entry(bytes);
        // Cut short anywhere, it is still only bytes.
        const std::size_t step = std::max<std::size_t>(1, bytes.size() / 16);
        for (std::size_t size = 0; size < bytes.size(); size += step) {
            target.entry(Bytes(bytes).first(size));
        }
    }
}
