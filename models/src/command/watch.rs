//! `mbd watch`: the page of a scene file, made anew when the file is saved, on an address of this machine alone.

use std::io::{Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, SystemTime};

use clap::Args;
use serde_json::json;

use super::failure::Failure;
use super::run::{self, RunArgs};

/// The page around the report: it asks for news, and shows mistakes where the report was.
const SHELL: &str = include_str!("watch.html");
/// How often the file is looked at.
const PAUSE: Duration = Duration::from_millis(250);
/// Nobody who asks for a page needs longer, or more words.
const PATIENCE: Duration = Duration::from_secs(5);
const LONGEST: usize = 16_384;

/// What to watch: as in `mbd run`.
#[derive(Args, Debug)]
pub struct WatchArgs {
    #[command(flatten)]
    run: RunArgs,
    /// Port of the loopback address [default: one that is free].
    #[arg(long, default_value_t = 0, hide_default_value = true)]
    port: u16,
}

/// What is shown.
#[derive(Debug, Default)]
struct Shown {
    /// Counts the runs.
    version: u64,
    /// The page of the last run that came to an end.
    page: String,
    /// What is wrong with the scene as it is now, or with its run.
    says: Option<String>,
}

/// Serves the page until it is interrupted.
pub fn watch(args: &WatchArgs) -> Result<String, Failure> {
    if !args.run.scene().is_file() {
        let text = format!(
            "`{}` is no file: `mbd watch` looks at a scene file and runs it anew when it is saved",
            args.run.scene().display()
        );
        return Err(Failure::Usage(text));
    }
    let listener = TcpListener::bind(SocketAddr::from((Ipv4Addr::LOCALHOST, args.port)));
    let address = listener.and_then(|listener| Ok((listener.local_addr()?, listener)));
    let (address, listener) = address
        .map_err(|error| Failure::Usage(format!("cannot serve on port {}: {error}", args.port)))?;
    eprintln!(
        "mbd: http://{address}/ shows {}; saving it runs it again, Ctrl-C ends",
        args.run.scene().display()
    );
    let shown = Arc::new(Mutex::new(Shown::default()));
    let served = Arc::clone(&shown);
    std::thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            let served = Arc::clone(&served);
            std::thread::spawn(move || serve(stream, address, &served));
        }
    });
    let mut last = None;
    loop {
        let now = stamp(args.run.scene());
        if last != Some(now) {
            last = Some(now);
            refresh(&args.run, &shown);
        }
        std::thread::sleep(PAUSE);
    }
}

/// When a file was written, and how long it is; `None` while it is being replaced.
fn stamp(file: &Path) -> Option<(SystemTime, u64)> {
    let about = file.metadata().ok()?;
    Some((about.modified().ok()?, about.len()))
}

/// Runs the scene and shows what came of it. After a mistake the last page stays, behind what is wrong.
fn refresh(args: &RunArgs, shown: &Mutex<Shown>) {
    let result = run::run(args);
    let has_page = matches!(
        &result,
        Ok(_) | Err(Failure::Inaccurate(_) | Failure::Aborted(_))
    );
    let page: PathBuf = args.folder().join("report.html");
    let read = has_page.then(|| std::fs::read_to_string(&page));
    let mut shown = shown.lock().unwrap_or_else(PoisonError::into_inner);
    shown.version += 1;
    shown.says = result.err().map(|failure| failure.to_string());
    match read {
        Some(Ok(page)) => shown.page = page,
        Some(Err(error)) => shown.says = Some(format!("cannot read {}: {error}", page.display())),
        None => {}
    }
}

/// Answers one request.
fn serve(mut stream: TcpStream, address: SocketAddr, shown: &Mutex<Shown>) {
    let _ = stream.set_read_timeout(Some(PATIENCE));
    let (mut head, mut part) = (Vec::new(), [0; 1024]);
    while !head.windows(4).any(|four| four == b"\r\n\r\n") && head.len() < LONGEST {
        match stream.read(&mut part) {
            Ok(0) | Err(_) => break,
            Ok(count) => head.extend_from_slice(&part[..count]),
        }
    }
    let shown = shown.lock().unwrap_or_else(PoisonError::into_inner);
    let answer = answer(&String::from_utf8_lossy(&head), address, &shown);
    drop(shown);
    // Who no longer listens misses nothing.
    let _ = stream.write_all(answer.as_bytes());
}

/// The answer to a request. Only requests to this very address are answered: a page from elsewhere whose name was made to lead here gets nothing.
fn answer(request: &str, address: SocketAddr, shown: &Shown) -> String {
    let mut lines = request.lines();
    let mut words = lines.next().unwrap_or_default().split(' ');
    let (method, path) = (
        words.next().unwrap_or_default(),
        words.next().unwrap_or_default(),
    );
    let host = lines.find_map(|line| {
        let (name, value) = line.split_once(':')?;
        name.eq_ignore_ascii_case("host")
            .then(|| value.trim().to_owned())
    });
    let ours = [address.to_string(), format!("localhost:{}", address.port())];
    if method != "GET" || !host.is_some_and(|host| ours.contains(&host)) {
        return reply("403 Forbidden", "text/plain", "only for this machine\n");
    }
    match path.split('?').next().unwrap_or_default() {
        "/" => reply("200 OK", "text/html", SHELL),
        "/report" => reply("200 OK", "text/html", &shown.page),
        "/state" => {
            let state = json!({
                "version": shown.version, "says": shown.says, "page": !shown.page.is_empty(),
            });
            reply("200 OK", "application/json", &state.to_string())
        }
        _ => reply("404 Not Found", "text/plain", "there is nothing here\n"),
    }
}

fn reply(status: &str, kind: &str, body: &str) -> String {
    format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}; charset=utf-8\r\nContent-Length: {}\r\nCache-Control: no-store\r\n\
         X-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n{body}",
        body.len()
    )
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Typed {
        #[command(flatten)]
        run: RunArgs,
    }

    const ADDRESS: SocketAddr = SocketAddr::new(std::net::IpAddr::V4(Ipv4Addr::LOCALHOST), 4000);

    fn asked(path: &str, host: &str, shown: &Shown) -> String {
        let request = format!("GET {path} HTTP/1.1\r\nHost: {host}\r\n\r\n");
        answer(&request, ADDRESS, shown)
    }

    #[test]
    fn saving_shows_the_new_run_and_a_mistake_stands_over_the_last_page() {
        let folder = std::env::temp_dir().join(format!("mbd_watch_{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let file = folder.join("stone.mbd");
        let scene = |height: &str| {
            format!(
                "/// A stone.\nmodel Stone {{ gravity: [0, 0, -9.81] m/s^2; point stone {{ mass: 1 kg, start at [0, 0, {height}] m }} }}\n[run]\nuntil = \"0.1 s\"\n"
            )
        };
        let out = folder.join("out");
        let typed =
            [&"mbd".into(), &file, &"--out".into(), &out].map(|part: &PathBuf| part.clone());
        let args = Typed::parse_from(typed).run;
        let shown = Mutex::new(Shown::default());
        std::fs::write(&file, scene("1")).expect("room");
        refresh(&args, &shown);
        let first = shown.lock().expect("nobody else").page.clone();
        assert!(first.contains("A stone."));
        std::fs::write(&file, scene("oops")).expect("room");
        refresh(&args, &shown);
        {
            let shown = shown.lock().expect("nobody else");
            let says = shown.says.as_deref().expect("a mistake");
            assert!(
                says.contains("stone.mbd:2:") && says.contains("oops"),
                "{says}"
            );
            assert_eq!((shown.page == first, shown.version), (true, 2));
            assert!(asked("/state?1", "127.0.0.1:4000", &shown).contains("oops"));
        }
        std::fs::write(&file, scene("2")).expect("room");
        refresh(&args, &shown);
        let shown = shown.lock().expect("nobody else");
        assert!(shown.says.is_none() && shown.page != first);
        assert!(asked("/report", "localhost:4000", &shown).ends_with(&shown.page));
        std::fs::remove_dir_all(folder).expect("ours");
    }

    #[test]
    fn only_this_machine_is_answered() {
        let shown = Shown::default();
        assert!(asked("/", "127.0.0.1:4000", &shown).starts_with("HTTP/1.1 200"));
        for (path, host) in [
            ("/", "evil.example"),
            ("/state", "evil.example:4000"),
            ("/", ""),
        ] {
            assert!(
                asked(path, host, &shown).starts_with("HTTP/1.1 403"),
                "{host}"
            );
        }
        assert!(asked("/other", "localhost:4000", &shown).starts_with("HTTP/1.1 404"));
        assert!(
            answer(
                "POST / HTTP/1.1\r\nHost: localhost:4000\r\n\r\n",
                ADDRESS,
                &shown
            )
            .starts_with("HTTP/1.1 403")
        );
        assert!(answer("", ADDRESS, &shown).starts_with("HTTP/1.1 403"));
    }
}
