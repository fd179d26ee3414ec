// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import "./style.css";
import { App } from "./app";

const scheme = location.protocol === "https:" ? "wss:" : "ws:";
// A server that listens beyond its own machine asks for the token of the address that it printed.
new App(`${scheme}//${location.host}/ws${location.search}`).start();
