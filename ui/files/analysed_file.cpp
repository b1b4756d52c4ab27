#include "ui/files/analysed_file.hpp"

#include "data/store/analysed.hpp"

namespace palpate::ui {

void analyse(data::Database& database, const std::string& versions, const std::string& study) {
    data::analyse(database,
                  versions == "together" ? data::Versions::together : data::Versions::apart, study);
}

}  // namespace palpate::ui
