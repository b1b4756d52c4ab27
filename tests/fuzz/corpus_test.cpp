#include "tests/fuzz/entries.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random.hpp"
#include "tests/support/slurp.hpp"

using namespace palpate::fuzz;

namespace {

std::vector<std::filesystem::path> files_of(std::string_view corpus) {
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
    const std::string bytes = palpate::tests::slurp(file);
    return {bytes.begin(), bytes.end()};
}

/// Pieces of `good` and of TOML and CSV, some of them repeated until they are deep or long.
std::vector<std::uint8_t> nonsense(std::uint64_t seed, const std::vector<std::uint8_t>& good) {
    const std::vector<std::string> parts{
        "[",  "]",  "{",      "}", ".", "=",  ",",    "\n", "\"",   "'",       "a", "\\",
        "[[", "]]", "\"\"\"", "#", "-", "1,", "a = ", "a.", "\xff", "[[a]]\n", "0", "nan,1\n"};
    palpate::tests::Random random(seed);
    const auto size = static_cast<std::size_t>(random.decade(3.0, 6.0));
    std::string text;
    while (text.size() < size) {
        if (random.below(4) == 0 && !good.empty()) {
            const auto from = random.index(good.size());
            const auto length = static_cast<std::size_t>(random.decade(0.0, 3.0));
            text.append(
                good.begin() + static_cast<std::ptrdiff_t>(from),
                good.begin() + static_cast<std::ptrdiff_t>(std::min(from + length, good.size())));
            continue;
        }
        const auto which = random.index(parts.size());
        for (int n = random.below(5) == 0 ? static_cast<int>(random.decade(0.0, 5.0)) : 1; n > 0;
             --n) {
            text += parts[which];
        }
    }
    text.resize(std::min(text.size(), std::size_t{1} << 20U));
    return {text.begin(), text.end()};
}

}  // namespace

TEST_CASE("texts of up to a megabyte, however deep, are read or refused") {
    const Entry entry = GENERATE(from_range(kEntries));
    if (!entry.text) {
        return;
    }
    const auto files = files_of(entry.name);
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        INFO(entry.name << " " << seed);
        const std::vector<std::uint8_t> bytes =
            nonsense(seed, bytes_of(files[seed % files.size()]));
        entry.feed(bytes);
    }
}

TEST_CASE("what the fuzzers were fed and found is read without harm") {
    const Entry entry = GENERATE(from_range(kEntries));
    const auto files = files_of(entry.name);
    CHECK(files.size() >= 3);
    for (const auto& file : files) {
        INFO(file.string());  // a breach ends the program: the last name printed is the culprit's
        std::vector<std::uint8_t> bytes = bytes_of(file);
        entry.feed(bytes);
        // Cut short anywhere, it is still only bytes.
        const std::size_t step = std::max<std::size_t>(1, bytes.size() / 16);
        for (std::size_t size = 0; size < bytes.size(); size += step) {
            entry.feed(Bytes(bytes).first(size));
        }
    }
}
