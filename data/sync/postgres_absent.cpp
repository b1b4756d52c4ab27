#include "data/sync/postgres.hpp"

/// In place of postgres.cpp where libpq is not installed.
namespace palpate::data {

PostgresRow& PostgresRow::none() {
    return *this;
}
PostgresRow& PostgresRow::text(std::string_view) {
    return *this;
}
PostgresRow& PostgresRow::integer(std::int64_t) {
    return *this;
}
PostgresRow& PostgresRow::real(double) {
    return *this;
}
PostgresRow& PostgresRow::bytes(std::span<const std::byte>) {
    return *this;
}

Postgres::Postgres(const std::string&) {
    throw std::invalid_argument(
        "this palpate was built without libpq: install libpq-dev, build again, and push");
}
Postgres::~Postgres() = default;
void Postgres::run(const std::string&) {}
std::vector<std::vector<std::optional<std::string>>> Postgres::rows(const std::string&,
                                                                    const PostgresRow&) {
    return {};
}
void Postgres::send(const std::string&, const PostgresRow&) {}
std::int64_t Postgres::flush() {
    return 0;
}

}  // namespace palpate::data
