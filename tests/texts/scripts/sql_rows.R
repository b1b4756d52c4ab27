a <- commandArgs(TRUE)
db <- DBI::dbConnect(RSQLite::SQLite(), a[1], loadable.extensions = TRUE)
invisible(DBI::dbExecute(db, sprintf("SELECT load_extension('%s')", a[2])))
for (query in a[-(1:2)]) {
  r <- DBI::dbGetQuery(db, query)
  r[] <- lapply(r, function(x) if (is.numeric(x)) sprintf('%.17g', x) else x)
  r[r == 'NA'] <- ''
  write.table(r, sep = ',', quote = FALSE, row.names = FALSE, col.names = FALSE, na = '')
  cat('end of query\n')
}
