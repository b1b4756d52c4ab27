#include "tests/support/catch.hpp"
#include "tests/support/content_hash.hpp"
#include "tests/support/process.hpp"

using namespace palpate;
using tests::palpate_command;
using tests::TemporaryFolder;

namespace {

std::string demo_hash(const std::string& file, const std::string& seed) {
    REQUIRE(palpate_command({"demo", "--headless", "--db", file, "--seed", seed}).code == 0);
    data::Database database(file, data::Access::read);
    return tests::content_hash(database);
}

}  // namespace

// The golden hash is this program's own, of its first release build: it holds for every build type,
// sanitizer and x86-64 machine, or a recorded trace would not replay there. It changes only with
// the stimulus, the law, the schedule, the schema or the demo's secret, and whoever changes one of
// these writes it anew.
TEST_CASE("same seed, same plan, same content: in two runs, and in every build",
          "[determinism][law]") {
    const TemporaryFolder folder;
    const std::string first = demo_hash(folder.file("a.sqlite"), "1");
    CHECK(demo_hash(folder.file("b.sqlite"), "1") == first);
    CHECK(demo_hash(folder.file("c.sqlite"), "2") != first);
    CHECK(first == "b4af348fe694fb71664f5fa35dc6ab159a204231f7cc925f49473dc11a5d3ea5");
}
