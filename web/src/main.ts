// SPDX-License-Identifier: MIT
import './style.css';
import { App } from './app/app';

new App();
