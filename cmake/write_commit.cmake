# SPDX-License-Identifier: Apache-2.0
# cmake -DSOURCE=FOLDER -DOUT=FILE -P write_commit.cmake: writes a header that names the commit of FOLDER. The header is
# rewritten only if the commit has changed, so that nothing is recompiled otherwise.
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=10 --exclude=*
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(commit "no commit")
endif()
file(CONFIGURE OUTPUT ${OUT} CONTENT "#pragma once\n#define UNDERSTUDY_COMMIT \"@commit@\"\n" @ONLY)
