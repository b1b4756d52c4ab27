#include "protocols/file/protocol_file.hpp"
#include "protocols/library/shipped.hpp"
#include "protocols/protocol/protocol.hpp"
#include "protocols/trial/trial_scene.hpp"
#include "data/store/reader.hpp"
#include "tests/support/program.hpp"
#include "tests/support/short_text.hpp"

namespace {

/// The shipped study with one repetition and without practice: eight trials. @param edit one more
/// edit
std::string study(const TemporaryFolder& folder,
                  const std::pair<std::string, std::string>& edit = {}) {
    const std::string file = folder.file("patches.toml");
    write(file,
          short_text("patch_friction", {{"repetitions = 5", "repetitions = 1"},
                                        {"practice_repetitions = 1", "practice_repetitions = 0"},
                                        edit}));
    return file;
}

Words run(const std::string& protocol, const std::string& db, const std::string& device) {
    return run_words(protocol, "P1", db, {"--headless", "--device", device});
}

/// One session, recorded once for all.
struct Recorded {
    TemporaryFolder folder;
    std::string protocol = study(folder);
    std::string file = folder.file("a.sqlite");

    Recorded() {
        const Finished ran = palpate_command(run(protocol, file, "sim"));
        INFO(ran.error);
        REQUIRE(ran.code == 0);
        REQUIRE_THAT(ran.out, Has("8 answered, 0 of them do not count, 0 faulted"));
    }
};

const Recorded& recorded() {
    static const Recorded session;
    return session;
}

/// The only row of a query, as CSV.
std::string row(const std::string& file, const std::string& sql) {
    const std::string csv = sql_csv(file, sql);
    const std::size_t head = csv.find('\n');
    std::string text = csv.substr(head + 1);
    text.erase(text.find_last_not_of("\r\n") + 1);
    return text;
}

}  // namespace

TEST_CASE("a session on surfaces is stored whole, and verify finds nothing in it",
          "[surface-session][law]") {
    const Recorded& session = recorded();
    CHECK_THAT(ran({"verify", session.file}).out, Has("Nothing differs"));
    // Nothing is stored in full: HIP follows from its columns, the contact from HIP, the command
    // from both.
    CHECK(row(session.file, "SELECT count(*) FROM trace_chunk WHERE holds <> ''") == "0");
    CHECK(row(session.file, "SELECT sum(length(data)) < 8 * sum(ticks) FROM trace_chunk") == "1");
    CHECK(row(session.file, "SELECT device FROM session") == "simulated gantry");
}

TEST_CASE("what sample says of surfaces is what their geometry and laws ask for",
          "[surface-session][law]") {
    const std::string& file = recorded().file;
    const std::string of =
        " FROM sample JOIN presentation AS p USING (trial_id, interval) WHERE mode <> 'free'";
    // F = K (GO - HIP) along each axis, 800 N/m.
    CHECK(row(file,
              "SELECT max(max(abs(rendered_x_n - 800 * (go_x_m - hip_x_m)), abs(rendered_y_n - 800 "
              "* (go_y_m - hip_y_m)), abs(rendered_z_n - 800 * (go_z_m - hip_z_m)))) < 1e-9" +
                  of) == "1");
    // Friction lies in the tangent plane: |F|^2 = Fn^2 + Ft^2, Ft <= mu Fn.
    CHECK(row(file,
              "SELECT max(abs(rendered_x_n * rendered_x_n + rendered_y_n * rendered_y_n + "
              "rendered_z_n * rendered_z_n - rendered_normal_n * rendered_normal_n - "
              "rendered_tangential_n * rendered_tangential_n)) < 1e-9 AND "
              "max(rendered_tangential_n - mu * rendered_normal_n) < 1e-9" +
                  of) == "1");
    CHECK(row(file, "SELECT max(rendered_tangential_n) > 0.5 AND max(mu) = 0.6 AND min(mu) = 0.4" +
                        of + " AND p.friction = 'on' AND mode <> 'stuck'") == "1");
    // Within the patch the god-object lies on a sphere of 125 mm, below or above its middle, or on
    // z = 0.
    const std::string within = of + " AND u BETWEEN 1 AND 2 AND v BETWEEN 1 AND 2";
    const auto on_sphere = [](const char* centre) {
        return std::string("SELECT max(abs(sqrt(go_x_m * go_x_m + go_y_m * go_y_m + (go_z_m - (") +
               centre + ")) * (go_z_m - (" + centre + "))) - 0.125)) < 1e-12 AND count(*) > 5000";
    };
    CHECK(row(file, on_sphere("-0.125") + within + " AND felt_object = 'convex'") == "1");
    CHECK(row(file, on_sphere("0.125") + within + " AND felt_object = 'concave'") == "1");
    CHECK(row(file, "SELECT max(abs(go_z_m)) < 1e-15 AND count(*) > 5000" + within +
                        " AND felt_object = 'flat'") == "1");
    // The saddle rises along x and falls along y.
    CHECK(row(file,
              "SELECT min(go_z_m) FILTER (WHERE abs(go_y_m) < 0.002 AND abs(go_x_m) > 0.01) > 0 "
              "AND max(go_z_m) FILTER (WHERE abs(go_x_m) < 0.002 AND abs(go_y_m) > 0.01) < 0" +
                  within + " AND felt_object = 'saddle'") == "1");
    // No other point of the object is nearer than the closest one; without friction the god-object
    // is it.
    CHECK(row(file,
              "SELECT max(abs(cp_x_m - go_x_m) + abs(cp_y_m - go_y_m) + abs(cp_z_m - go_z_m)) < "
              "1e-9" +
                  within + " AND p.friction = 'off'") == "1");
    // The command is within its limit, and codes are its mN.
    CHECK(row(file,
              "SELECT max(commanded_x_n * commanded_x_n + commanded_y_n * commanded_y_n + "
              "commanded_z_n * commanded_z_n) <= 64.001 AND max(abs(code_3 - 1000 * "
              "commanded_z_n)) <= 0.6 AND max(commanded_z_n) > 1.5 FROM sample") == "1");
    CHECK(row(file,
              "SELECT min(covered_share) > 0.1 AND max(covered_share) <= 1 AND min(strokes) > 5 "
              "AND max(vertex_ticks) = 0 FROM presentation") == "1");
}

TEST_CASE(
    "recorded forces on surfaces come back to the bit from the database alone, and again on a "
    "replayed hand",
    "[surface-session][law]") {
    const Recorded& session = recorded();
    data::Database database(session.file, data::Access::read);
    auto text = database.first("SELECT protocol_toml FROM study");
    const protocols::Protocol protocol = protocols::parse_protocol(text.text(0), "stored");
    auto trial = database.prepare(
        "SELECT trial_id, felt_object, friction, slip_decay, heal_decay FROM presentation");
    int replayed = 0;
    while (trial.step()) {
        const auto find = [](const auto& list, const std::string& name) {
            return *std::find_if(list.begin(), list.end(),
                                 [&](const auto& one) { return one.name == name; });
        };
        engine::FeltScene scene = protocols::make_felt_scene(
            protocol, {.object = find(protocol.objects, trial.text(1)),
                       .friction = find(protocol.frictions, trial.text(2))});
        scene.restore_decay({trial.real(3), trial.real(4)});
        engine::SurfaceState state;
        for (const engine::TickRecord& tick : data::TraceReader(database).read(trial.integer(0))) {
            const engine::SurfaceContact contact = scene.space()->tick(state, tick.hip);
            REQUIRE(std::memcmp(&contact.force, &tick.force, sizeof tick.force) == 0);
            REQUIRE((contact.mode == tick.mode && contact.go_v == tick.v));
            ++replayed;
        }
    }
    CHECK(replayed > 40'000);

    const std::string again = session.folder.file("again.sqlite");
    ran(run(session.protocol, again, "replay:" + session.file));
    const char* const forces =
        "SELECT trial_id, count(*), sum(rendered_x_n), sum(rendered_y_n), sum(rendered_z_n), sum(u "
        "* v) FROM sample WHERE tick < 3000 GROUP BY trial_id";
    CHECK(palpate_command({"sql", again, "-c", forces}).out ==
          palpate_command({"sql", session.file, "-c", forces}).out);
}

TEST_CASE("an export of surfaces has every coordinate", "[surface-session][export]") {
    const Recorded& session = recorded();
    const std::string out = session.folder.file("csv");
    ran({"export", session.file, "-o", out, "--kind", "simulated", "--traces"});
    std::ifstream columns(out + "/columns.csv");
    std::stringstream text;
    text << columns.rdbuf();
    CHECK_THAT(text.str(), Has("hip_z_m", "go_z_m", "cp_z_m", "rendered_z_n", "commanded_z_n"));
}

TEST_CASE("a report of surfaces names both curvatures of each patch", "[surface-session][report]") {
    const Recorded& session = recorded();
    const std::string page = session.folder.file("report.html");
    ran({"report", session.file, "--kind", "simulated", "--simulations", "19", "--bootstrap", "19",
         "-o", page});
    std::ifstream file(page);
    std::stringstream text;
    text << file.rdbuf();
    CHECK_THAT(text.str(), Has("saddle (-8 and 8 1/m)"));
}

TEST_CASE("another friction than what was felt is found", "[surface-session][verify]") {
    const Recorded& session = recorded();
    const std::string copy = session.folder.file("changed.sqlite");
    std::filesystem::copy_file(session.file, copy,
                               std::filesystem::copy_options::overwrite_existing);
    {
        data::Database database(copy, data::Access::write);
        database.execute(
            "UPDATE presentation SET mu_d = 0.5 WHERE trial_id = (SELECT min(trial_id) FROM "
            "presentation WHERE friction = 'on')");
    }
    CHECK_THAT(ran({"verify", copy}, 1).out, Has("presentation.mu_d"));
}

TEST_CASE("surfaces are refused on machines in a plane, and with what only planes have, by name",
          "[surface-session]") {
    const TemporaryFolder folder;
    const std::string protocol = study(folder);
    for (const char* device : {"haply-emulator", "haply:/dev/null", "mouse"}) {
        CAPTURE(device);
        CHECK_THAT(ran(run(protocol, folder.file("a.sqlite"), device), 2).error,
                   Has("patch_friction", "give --device sim"));
        CHECK(!std::filesystem::exists(folder.file("a.sqlite")));
    }
    const auto said = [](const std::string& from, const std::string& to) {
        const TemporaryFolder own;
        const Finished checked = ran({"check", study(own, {from, to})}, 2);
        return checked.error + checked.out;
    };
    CHECK_THAT(said("[surface] ", "[outline]\na_mm = [-40, 0]\n[surface] "),
               Has("[outline] is given beside [surface]"));
    CHECK_THAT(said("curvature_per_m = 0\n", "curvature_per_m = 30\n"),
               Has("a curvature of 30 1/m is too strong for a patch of 60 mm"));
    CHECK_THAT(said("curvature_per_m = 0\n", "curvature_per_m = 0\nsize = 2\n"),
               Has("the object flat has segments, a place or a compliance"));
    CHECK_THAT(said("law = \"gos\"\nmu_s = 0.6\nmu_d = 0.4\ntau_slip_ms = 20\ntau_heal_ms = 100",
                    "law = \"viscous\"\nmu_d = 0.4\nviscous_n_s_per_m = 1"),
               Has("which surfaces do not have"));
}
