#include "data/store/secret.hpp"

#include <charconv>
#include <optional>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/sha256.hpp"
#include "data/store/row.hpp"
#include "data/store/uuid.hpp"

namespace palpate::data {
namespace {

/// With which nothing was drawn, in the order of their digits. The demo's counts for nothing.
std::vector<std::string> unused(Database& database) {
    std::vector<std::string> all =
        texts(database.prepare("SELECT hex FROM secret WHERE hex <> ?1 AND hex NOT IN (SELECT "
                               "secret FROM session) ORDER BY hex",
                               kDemoSecret));
    std::erase_if(all, [&database](const std::string& secret) {
        for (const Statement& person :
             database.prepare("SELECT participant_code, subject FROM participant")) {
            if (drawn_with(secret, person.text(0), person.integer(1))) {
                return true;
            }
        }
        return false;
    });
    return all;
}

/// With which the first session of people was drawn, or without one the first person's number: rows
/// that somebody adds come later. None: nothing was drawn yet.
std::optional<std::string> first_used(Database& database) {
    Statement session = database.prepare(
        "SELECT secret FROM session WHERE secret <> ?1 ORDER BY session_id LIMIT 1", kDemoSecret);
    if (session.step()) {
        return session.text(0);
    }
    for (const Statement& drawn :
         database.prepare("SELECT hex, participant_code, subject FROM participant, secret WHERE "
                          "hex <> ?1 ORDER BY participant_id, hex",
                          kDemoSecret)) {
        if (drawn_with(drawn.text(0), drawn.text(1), drawn.integer(2))) {
            return drawn.text(0);
        }
    }
    return std::nullopt;
}

/// How many there are, without the demo's.
std::size_t secrets_in(Database& database) {
    return static_cast<std::size_t>(
        database.first("SELECT count(*) FROM secret WHERE hex <> ?1", kDemoSecret).integer(0));
}

}  // namespace

bool anybody_in(Database& database) {
    return database.prepare("SELECT 1 FROM session UNION ALL SELECT 1 FROM participant").step();
}

bool drawn_with(std::string_view secret, std::string_view code, std::int64_t subject) {
    constexpr int kDraws = 10;
    int draw = 0;
    while (draw < kDraws && subject_of(code, secret, draw) != subject) {
        ++draw;
    }
    return draw < kDraws;
}

std::vector<std::string> strange_secrets(Database& database) {
    return secrets_in(database) > 1 ? unused(database) : std::vector<std::string>();
}

void drop_unused_secrets(Database& database) {
    const std::vector<std::string> all = unused(database);
    if (all.size() == 1 && secrets_in(database) == 1) {
        return;
    }
    for (const std::string& secret : all) {
        database.run("DELETE FROM secret WHERE hex = ?1", secret);
    }
    if (secrets_in(database) == 0) {
        Row("secret").set("hex", random_secret()).insert(database);
    }
}

std::int64_t subject_of(std::string_view code, std::string_view secret, int draw) {
    const std::string hash = sha256_hex(fmt::format(
        "palpate-subject-v1\ncode={}:{}\nsecret={}\ndraw={}\n", code.size(), code, secret, draw));
    std::uint64_t number = 0;
    std::from_chars(hash.data(), hash.data() + 15, number, 16);
    return static_cast<std::int64_t>(number % 9'999'999'999U) + 1;
}

std::string own_secret(Database& database) {
    refuse_if<StoreError>(!strange_secrets(database).empty(),
                          "{}: it has a second secret, with which nothing was drawn: somebody put "
                          "it there to know whose the next orders are; take a copy made before",
                          database.file());
    const std::optional<std::string> used = first_used(database);
    if (used && database.prepare("SELECT 1 FROM secret WHERE hex = ?1", *used).step()) {
        return *used;
    }
    Statement row = database.first("SELECT min(hex) FROM secret");
    refuse_if<StoreError>(used || row.null(0),
                          "{}: its secret was removed or changed, and without it no order can be "
                          "drawn or checked; move it away, with its -wal and -shm, and restore a "
                          "copy",
                          database.file());
    return row.text(0);
}

void check_secret(std::string_view hex) {
    refuse_if(
        hex.size() != 32 || hex.find_first_not_of("0123456789abcdef") != std::string::npos,
        "--secret is not 32 of the digits 0 to 9 and a to f; openssl rand -hex 16 prints one");
}

void set_secret(Database& database, std::string_view hex) {
    Transaction all(database);
    if (own_secret(database) == hex) {
        return;
    }
    refuse_if(anybody_in(database),
              "{}: it has a secret of its own, with which people are numbered and their orders "
              "drawn: leave --secret out, or begin another file",
              database.file());
    database.execute("DELETE FROM secret");
    keep_secret(database, hex);
    all.commit();
}

void keep_secret(Database& database, std::string_view hex) {
    if (hex != kDemoSecret && !anybody_in(database)) {
        database.execute("DELETE FROM secret");
    }
    Row("secret").set("hex", hex).insert(database, "ON CONFLICT DO NOTHING");
}

std::int64_t participant_row(Database& database, std::string_view code, std::string_view secret) {
    Statement there = database.prepare(
        "SELECT participant_id FROM participant WHERE participant_code = ?1", code);
    if (there.step()) {
        return there.integer(0);
    }
    Statement taken = database.prepare("SELECT 1 FROM participant WHERE subject = ?1");
    std::int64_t subject = subject_of(code, secret, 0);
    for (int draw = 1; taken.bind(1, subject).step(); ++draw) {
        subject = subject_of(code, secret, draw);
        taken.reset();
    }
    return Row("participant")
        .set("participant_code", code)
        .set("subject", subject)
        .insert(database);
}

}  // namespace palpate::data
