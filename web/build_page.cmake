# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# The two steps of building the page, run by CMakeLists.txt as scripts:
#   cmake -DSTEP=install -DNPM=... -DSOURCE=... -DWORK=... -DSTAMP=... -DREQUIRED=ON|OFF -P build_page.cmake
#   cmake -DSTEP=bundle -DNODE=... -DSOURCE=... -DWORK=... -DDIST=... -P build_page.cmake
# Where packages cannot be fetched and the page is not required, no stamp is written (the next build
# tries again) and the bundle stays empty.

function(install)
  file(REMOVE "${STAMP}")
  file(COPY ${SOURCE}/package.json ${SOURCE}/package-lock.json ${SOURCE}/.npmrc DESTINATION "${WORK}")
  execute_process(COMMAND "${NPM}" ci --no-audit --no-fund --prefer-offline --loglevel=error
                          --fetch-retries=1
                  WORKING_DIRECTORY "${WORK}" RESULT_VARIABLE status)
  if(status EQUAL 0)
    file(TOUCH "${STAMP}")
    return()
  endif()
  file(REMOVE_RECURSE "${WORK}/node_modules")
  set(problem "npm could not install the packages of the viewer's page (see above)")
  if(REQUIRED)
    message(FATAL_ERROR "${problem}. -DSGS_WEB=AUTO builds without the page.")
  endif()
  message(WARNING "${problem}: built without the page. -DSGS_WEB=OFF does not try.")
endfunction()

function(bundle)
  file(REMOVE_RECURSE "${WORK}/src" "${DIST}")
  file(MAKE_DIRECTORY "${DIST}")
  if(NOT EXISTS "${WORK}/node_modules")
    return()
  endif()
  file(COPY ${SOURCE}/src ${SOURCE}/index.html ${SOURCE}/vite.config.ts ${SOURCE}/tsconfig.json
       DESTINATION "${WORK}")
  execute_process(COMMAND "${NODE}" node_modules/vite/bin/vite.js build --outDir "${DIST}"
                          --emptyOutDir --logLevel warn
                  WORKING_DIRECTORY "${WORK}" RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "vite could not build the page (see above)")
  endif()
endfunction()

cmake_language(CALL ${STEP})
