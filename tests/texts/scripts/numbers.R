words <- commandArgs(trailingOnly = TRUE)
table <- read.csv(gzfile(words[1]), stringsAsFactors = FALSE, colClasses = "character")
numbers <- sapply(c("hip_x_m", "hip_y_m", "rendered_x_n", "rendered_y_n", "u"),
                  function(name) as.numeric(table[[name]]))
plain <- read.csv(gzfile(words[1]), stringsAsFactors = FALSE)
stopifnot(identical(as.vector(numbers[, "rendered_x_n"]), as.numeric(plain$rendered_x_n)))
writeBin(as.vector(t(numbers)), words[2], size = 8, endian = "little")
