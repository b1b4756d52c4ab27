#include "data/sync/postgres.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include <fmt/format.h>
#include <libpq-fe.h>

#include "data/export/number_text.hpp"

namespace palpate::data {
namespace {

constexpr Oid kBytea = 17;

PGconn* of(void* connection) {
    return static_cast<PGconn*>(connection);
}

class Result {
public:
    explicit Result(PGresult* result) : result_(result) {}
    Result(const Result&) = delete;
    Result& operator=(const Result&) = delete;
    ~Result() { PQclear(result_); }
    [[nodiscard]] PGresult* get() const { return result_; }
    [[nodiscard]] bool good() const {
        const ExecStatusType status = PQresultStatus(result_);
        return status == PGRES_COMMAND_OK || status == PGRES_TUPLES_OK;
    }

private:
    PGresult* result_;
};

/// What libpq asks for, as long as the row lives.
struct Parameters {
    std::vector<const char*> values;
    std::vector<int> lengths, formats;
    std::vector<Oid> types;
};

/// A wrong URL is not repeated, by libpq neither: its words could hold the password.
void require_url(const std::string& url) {
    const bool ours = url.starts_with("postgresql://") || url.starts_with("postgres://");
    PQconninfoOption* parsed = ours ? PQconninfoParse(url.c_str(), nullptr) : nullptr;
    const bool good = parsed != nullptr;
    PQconninfoFree(parsed);
    if (!good) {
        throw std::invalid_argument(
            "--to is no URL of a PostgreSQL server: give postgresql://USER@HOST/DATABASE, signs "
            "other than "
            "letters and digits as %XX");
    }
}

}  // namespace

PostgresRow& PostgresRow::none() {
    values_.push_back({{}, false, true});
    return *this;
}
PostgresRow& PostgresRow::text(std::string_view value) {
    values_.push_back({std::string(value), false, false});
    return *this;
}
PostgresRow& PostgresRow::integer(std::int64_t value) {
    return text(fmt::format("{}", value));
}
PostgresRow& PostgresRow::real(double value) {
    return text(number_text(value));
}
PostgresRow& PostgresRow::bytes(std::span<const std::byte> value) {
    values_.push_back(
        {std::string(reinterpret_cast<const char*>(value.data()), value.size()), true, false});
    return *this;
}

Postgres::Postgres(const std::string& url) {
    require_url(url);
    connection_ = PQconnectdb(url.c_str());
    if (PQstatus(of(connection_)) != CONNECTION_OK) {
        try {
            fail("connecting", PQerrorMessage(of(connection_)));
        } catch (...) {
            PQfinish(of(connection_));
            throw;
        }
    }
    // What the server remarks would go to standard error as it comes; what fails is thrown.
    PQsetNoticeProcessor(
        of(connection_), [](void*, const char*) {}, nullptr);
    run("SET client_min_messages = warning; SET client_encoding = 'UTF8'");
}

Postgres::~Postgres() {
    PQfinish(of(connection_));
}

void Postgres::fail(std::string_view doing, const char* words) const {
    std::string said = words;
    const char* password = PQpass(of(connection_));
    for (std::size_t at = 0; password != nullptr && *password != '\0' &&
                             (at = said.find(password)) != std::string::npos;) {
        said.replace(at, std::strlen(password), "...");
        if (std::strstr("...", password) != nullptr) {
            break;
        }
    }
    while (!said.empty() && said.back() == '\n') {
        said.pop_back();
    }
    for (std::size_t at = 0; (at = said.find_first_of("\n\t", at)) != std::string::npos;) {
        const std::size_t end = std::min(said.find_first_not_of("\n\t", at), said.size());
        said.replace(at, end - at, "; ");
    }
    const char* host = PQhost(of(connection_));
    throw PostgresError(fmt::format("PostgreSQL at {}: {} failed: {}",
                                    host == nullptr || *host == '\0' ? "?" : host, doing, said));
}

void Postgres::run(const std::string& sql) {
    const Result result(PQexec(of(connection_), sql.c_str()));
    if (!result.good()) {
        fail("a statement", PQerrorMessage(of(connection_)));
    }
}

namespace {
template <class Values>
Parameters parameters_of(const Values& values) {
    Parameters all;
    for (const auto& value : values) {
        all.values.push_back(value.null ? nullptr : value.bytes.data());
        all.lengths.push_back(static_cast<int>(value.bytes.size()));
        all.formats.push_back(value.binary ? 1 : 0);
        all.types.push_back(value.binary ? kBytea : 0);
    }
    return all;
}
}  // namespace

std::vector<std::vector<std::optional<std::string>>> Postgres::rows(const std::string& sql,
                                                                    const PostgresRow& row) {
    const Parameters all = parameters_of(row.values_);
    const Result result(PQexecParams(of(connection_), sql.c_str(),
                                     static_cast<int>(all.values.size()), all.types.data(),
                                     all.values.data(), all.lengths.data(), all.formats.data(), 0));
    if (!result.good()) {
        fail("a query", PQerrorMessage(of(connection_)));
    }
    std::vector<std::vector<std::optional<std::string>>> found;
    for (int line = 0; line < PQntuples(result.get()); ++line) {
        auto& values = found.emplace_back();
        for (int column = 0; column < PQnfields(result.get()); ++column) {
            const bool null = PQgetisnull(result.get(), line, column) != 0;
            values.push_back(
                null ? std::nullopt
                     : std::optional<std::string>(PQgetvalue(result.get(), line, column)));
        }
    }
    return found;
}

void Postgres::send(const std::string& sql, const PostgresRow& row) {
    const Parameters all = parameters_of(row.values_);
    if ((waiting_ == 0 && PQenterPipelineMode(of(connection_)) == 0) ||
        PQsendQueryParams(of(connection_), sql.c_str(), static_cast<int>(all.values.size()),
                          all.types.data(), all.values.data(), all.lengths.data(),
                          all.formats.data(), 0) == 0) {
        fail("sending rows", PQerrorMessage(of(connection_)));
    }
    ++waiting_;
}

std::int64_t Postgres::flush() {
    if (waiting_ == 0) {
        return 0;
    }
    // Without BEGIN, all statements up to a sync are one transaction.
    if (PQpipelineSync(of(connection_)) == 0) {
        fail("sending rows", PQerrorMessage(of(connection_)));
    }
    std::int64_t added = 0;
    std::string wrong;
    bool ended = false;
    for (bool synced = false; !synced;) {
        PGresult* next = PQgetResult(of(connection_));
        if (next == nullptr) {
            // The end of a statement's results. Twice in a row nothing is left to wait for, and the sync did
            // not come: the server is gone, whatever PQstatus says.
            if (ended || PQstatus(of(connection_)) != CONNECTION_OK) {
                fail("sending rows",
                     wrong.empty() ? PQerrorMessage(of(connection_)) : wrong.c_str());
            }
            ended = true;
            continue;
        }
        ended = false;
        const Result result(next);
        const ExecStatusType status = PQresultStatus(next);
        synced = status == PGRES_PIPELINE_SYNC;
        if (status == PGRES_COMMAND_OK) {
            added += std::atoll(PQcmdTuples(next));
        } else if (!synced && status != PGRES_PIPELINE_ABORTED && wrong.empty()) {
            wrong = PQresultErrorMessage(next);
        }
    }
    waiting_ = 0;
    PQexitPipelineMode(of(connection_));
    if (!wrong.empty()) {
        fail("adding rows", wrong.c_str());
    }
    return added;
}

}  // namespace palpate::data
