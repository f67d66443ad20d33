# SPDX-License-Identifier: Apache-2.0
# cmake -DSOURCE=FOLDER -DOUT=FILE -P write_commit.cmake: a header that names the commit of FOLDER; written where it is
# another than before, so that nothing is compiled for the same one.
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=10 --exclude=*
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(commit "no commit")
endif()
file(CONFIGURE OUTPUT ${OUT} CONTENT "#pragma once\n#define UNDERSTUDY_COMMIT \"@commit@\"\n" @ONLY)
