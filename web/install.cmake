# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# cmake -DNPM=... -DFOLDER=... -P install.cmake: installs the locked packages and says what to do
# where that fails.
execute_process(COMMAND "${NPM}" ci --no-audit --no-fund --prefer-offline --loglevel=error
                WORKING_DIRECTORY "${FOLDER}" RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "npm could not install the packages of the viewer's page (see above). "
                      "To build without the page: cmake -DSGS_WEB=OFF")
endif()
