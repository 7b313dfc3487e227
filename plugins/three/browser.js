// Headless Chromium with WebGL 2 in software.
import { existsSync } from 'node:fs';
import { chromium } from 'playwright-core';

/** Path of Chromium: $CHROMIUM, else where Debian has it. */
export const executable = process.env.CHROMIUM ?? '/usr/bin/chromium';

/** False, or the reason why there is no browser. */
export const missing = existsSync(executable) ? false : `browser tests need Chromium at ${executable} (or $CHROMIUM)`;

export function launch() {
  return chromium.launch({
    executablePath: executable,
    args: [
      '--no-sandbox',
      '--disable-quic',
      '--disable-background-networking',
      '--disable-component-update',
      '--disable-sync',
      '--use-angle=swiftshader',
      '--enable-unsafe-swiftshader',
    ],
  });
}

/** Opens a page and collects its errors and warnings in `page.problems`. */
export async function open(browser, url, options = {}) {
  const context = await browser.newContext(options);
  const page = await context.newPage();
  page.setDefaultTimeout(120_000);
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  page.on('console', (message) => {
    if (message.type() === 'error' || message.type() === 'warning') page.problems.push(message.text());
  });
  await page.goto(url);
  return page;
}
