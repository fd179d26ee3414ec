// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import "./style.css";
import { App } from "./app";

const scheme = location.protocol === "https:" ? "wss:" : "ws:";
new App(`${scheme}//${location.host}/ws`).start();
