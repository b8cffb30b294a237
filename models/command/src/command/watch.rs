//! `mbd watch`: the page of a scene file, made anew when the file or one that it names is saved, on an address of this machine alone.

use std::io::{Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, SystemTime};

use clap::Args;
use serde_json::json;

use super::failure::CommandFailure;
use super::run::{self, RunArgs};

/// The page around the report: it asks for news, and shows mistakes where the report was.
const SHELL: &str = include_str!("watch.html");
/// How often the files are looked at.
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
struct ShownPage {
    /// Counts the runs.
    version: u64,
    /// The page of the last run that came to an end.
    page: String,
    /// What is wrong with the scene as it is now, or with its run.
    says: Option<String>,
}

/// Serves the page until it is interrupted.
pub fn watch(args: &WatchArgs) -> Result<String, CommandFailure> {
    let server = Server::open(args)?;
    eprintln!(
        "mbd: http://{}/ shows {}; saving it, or a file that it names, runs it again, Ctrl-C ends",
        server.address,
        args.run.scene().display()
    );
    server.follow(&args.run, || false);
    Ok(String::new())
}

/// A page that is served.
struct Server {
    address: SocketAddr,
    shown: Arc<Mutex<ShownPage>>,
}

impl Server {
    /// Begins to serve, in threads of its own.
    fn open(args: &WatchArgs) -> Result<Server, CommandFailure> {
        if !args.run.scene().is_file() {
            let text = format!(
                "`{}` is no file: `mbd watch` looks at a scene file and runs it anew when it is saved",
                args.run.scene().display()
            );
            return Err(CommandFailure::Usage(text));
        }
        let listener = TcpListener::bind(SocketAddr::from((Ipv4Addr::LOCALHOST, args.port)));
        let address = listener.and_then(|listener| Ok((listener.local_addr()?, listener)));
        let (address, listener) = address.map_err(|error| {
            CommandFailure::Usage(format!("cannot serve on port {}: {error}", args.port))
        })?;
        let shown = Arc::new(Mutex::new(ShownPage::default()));
        let served = Arc::clone(&shown);
        std::thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let served = Arc::clone(&served);
                std::thread::spawn(move || serve(stream, address, &served));
            }
        });
        Ok(Server { address, shown })
    }

    /// Runs the scene now, and again whenever a file changes that it is made of.
    fn follow(&self, args: &RunArgs, ended: impl Fn() -> bool) {
        let mut watched = WatchedFiles::default();
        while !ended() {
            if watched.has_changed() {
                // What is saved while it runs is seen behind it.
                watched.renew(args.files());
                refresh(args, &self.shown);
            }
            std::thread::sleep(PAUSE);
        }
    }
}

/// When a file was written, and how long it is; `None` while it is not there.
type Stamp = Option<(SystemTime, u64)>;

fn stamp(file: &Path) -> Stamp {
    let about = file.metadata().ok()?;
    Some((about.modified().ok()?, about.len()))
}

/// Files as they were when the scene was run.
#[derive(Debug, Default)]
struct WatchedFiles(Vec<(PathBuf, Stamp)>);

impl WatchedFiles {
    /// Whether one of them changed, or nothing has been run yet.
    fn has_changed(&self) -> bool {
        self.0.is_empty() || self.0.iter().any(|(file, before)| stamp(file) != *before)
    }

    /// Takes these files as they are now. Where not all can be read, what was named before may be named again when the mistake is mended.
    fn renew(&mut self, (mut files, whole): (Vec<PathBuf>, bool)) {
        let before = std::mem::take(&mut self.0).into_iter();
        let before = before.map(|(file, _)| file).filter(|_| !whole);
        for file in before.collect::<Vec<_>>() {
            if !files.contains(&file) {
                files.push(file);
            }
        }
        let now = |file: PathBuf| {
            let stamp = stamp(&file);
            (file, stamp)
        };
        self.0 = files.into_iter().map(now).collect();
    }
}

/// Runs the scene and shows what came of it. After a mistake the last page stays, behind what is wrong.
fn refresh(args: &RunArgs, shown: &Mutex<ShownPage>) {
    let result = run::run(args);
    let has_page = matches!(
        &result,
        Ok(_) | Err(CommandFailure::Inaccurate(_) | CommandFailure::Aborted(_))
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
fn serve(mut stream: TcpStream, address: SocketAddr, shown: &Mutex<ShownPage>) {
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
fn answer(request: &str, address: SocketAddr, shown: &ShownPage) -> String {
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
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::thread::JoinHandle;

    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Typed {
        #[command(flatten)]
        run: RunArgs,
    }

    const ADDRESS: SocketAddr = SocketAddr::new(std::net::IpAddr::V4(Ipv4Addr::LOCALHOST), 4000);

    fn asked(path: &str, host: &str, shown: &ShownPage) -> String {
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
        let shown = Mutex::new(ShownPage::default());
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

    /// A folder of scene files, and a server that follows the first until it is dropped.
    struct Followed {
        folder: PathBuf,
        address: SocketAddr,
        ended: Arc<AtomicBool>,
        follower: Option<JoinHandle<()>>,
    }

    impl Followed {
        fn of(name: &str, files: &[(&str, &str)]) -> Followed {
            let folder = std::env::temp_dir().join(format!("mbd_{name}_{}", std::process::id()));
            std::fs::create_dir_all(&folder).expect("a folder");
            for (file, text) in files {
                std::fs::write(folder.join(file), text).expect("room");
            }
            let (scene, out) = (folder.join(files[0].0), folder.join("out"));
            let typed = [&"mbd".into(), &scene, &"--out".into(), &out];
            let args = WatchArgs {
                run: Typed::parse_from(typed.map(|part: &PathBuf| part.clone())).run,
                port: 0,
            };
            let server = Server::open(&args).expect("a free port");
            let ended = Arc::new(AtomicBool::new(false));
            let (address, seen) = (server.address, Arc::clone(&ended));
            let follow = move || server.follow(&args.run, || seen.load(Ordering::Relaxed));
            Followed {
                folder,
                address,
                ended,
                follower: Some(std::thread::spawn(follow)),
            }
        }

        /// What the server answers.
        fn get(&self, path: &str) -> String {
            let mut stream = TcpStream::connect(self.address).expect("somebody who listens");
            let request = format!("GET {path} HTTP/1.1\r\nHost: {}\r\n\r\n", self.address);
            stream.write_all(request.as_bytes()).expect("an ear");
            let mut answer = String::new();
            stream.read_to_string(&mut answer).expect("an answer");
            let (head, body) = answer.split_once("\r\n\r\n").expect("a body");
            assert!(head.starts_with("HTTP/1.1 200"), "{head}");
            body.to_owned()
        }

        /// The state after so many runs.
        fn after(&self, runs: u64) -> serde_json::Value {
            for _ in 0..400 {
                let state: serde_json::Value =
                    serde_json::from_str(&self.get("/state")).expect("JSON");
                match state["version"].as_u64() {
                    Some(version) if version >= runs => {
                        assert_eq!(version, runs, "{state}");
                        return state;
                    }
                    _ => std::thread::sleep(PAUSE / 5),
                }
            }
            panic!("no run {runs}");
        }

        /// Saves a file at once, so that nobody sees a half of it.
        fn save(&self, file: &str, text: &str) {
            let part = self.folder.join("part");
            std::fs::write(&part, text).expect("room");
            std::fs::rename(part, self.folder.join(file)).expect("one folder");
        }
    }

    impl Drop for Followed {
        fn drop(&mut self) {
            self.ended.store(true, Ordering::Relaxed);
            let _ = self.follower.take().map(JoinHandle::join);
            let _ = std::fs::remove_dir_all(&self.folder);
        }
    }

    /// A robot of one link on a hinge, of this mass in kilograms.
    fn robot(mass: &str) -> String {
        format!(
            "<robot name=\"arm\"><link name=\"base\"/><link name=\"rod\"><inertial><origin xyz=\"0 0 -0.5\"/><mass value=\"{mass}\"/>\
             <inertia ixx=\"0.1\" iyy=\"0.1\" izz=\"0.1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\
             <joint name=\"pin\" type=\"continuous\"><parent link=\"base\"/><child link=\"rod\"/><axis xyz=\"0 1 0\"/></joint></robot>"
        )
    }

    const ROBOT: &str = "model Arm { urdf: \"arm.urdf\" { angle: { damping: 0.1 N*m*s } } output turn = pin.angle; }\n[run]\nuntil = \"0.1 s\"\n";

    #[test]
    fn saving_a_urdf_that_the_scene_names_runs_it_again() {
        let shown = Followed::of(
            "watch_urdf",
            &[("arm.mbd", ROBOT), ("arm.urdf", &robot("1.25"))],
        );
        let first = shown.after(1);
        assert!(first["says"].is_null() && first["page"] == true, "{first}");
        let page = shown.get("/report");
        assert!(page.contains("1.25"), "the mass is on the page");
        shown.save("arm.urdf", &robot("7.75"));
        assert!(shown.after(2)["says"].is_null());
        let heavier = shown.get("/report");
        assert!(heavier.contains("7.75") && heavier != page);
        // A mistake in the URDF stands above the last page, and goes when it is mended.
        shown.save("arm.urdf", &robot("heavy"));
        let state = shown.after(3);
        let says = state["says"].as_str().expect("a mistake");
        assert!(
            says.contains("arm.urdf") && says.contains("heavy"),
            "{says}"
        );
        assert_eq!(shown.get("/report"), heavier);
        // While the scene is broken, too, the robot is still looked at.
        shown.save("arm.mbd", &ROBOT[..20]);
        shown.after(4);
        shown.save("arm.urdf", &robot("2.5"));
        shown.after(5);
        shown.save("arm.mbd", ROBOT);
        assert!(shown.after(6)["says"].is_null());
        assert!(shown.get("/report").contains("2.5"));
    }

    #[test]
    fn a_file_that_is_not_there_is_waited_for_and_the_scenes_that_go_on_are_looked_at() {
        let going = "model Rise { gravity: none; point stone { mass: 1 kg, start at [0, 0, 0] m velocity [0, 0, 1] m/s } event up = time rises 0.1 s { then: scene \"fall.mbd\" } }\n[run]\nuntil = \"0.2 s\"\n";
        let fall = |pull: &str| {
            format!(
                "model Fall {{ gravity: [0, 0, -{pull}] m/s^2; point stone {{ mass: 1 kg }} }}\n"
            )
        };
        let shown = Followed::of("watch_next", &[("rise.mbd", going)]);
        let state = shown.after(1);
        let says = state["says"].as_str().expect("a mistake");
        assert!(says.contains("fall.mbd"), "{says}");
        shown.save("fall.mbd", &fall("9.81"));
        let state = shown.after(2);
        assert!(state["says"].is_null() && state["page"] == true, "{state}");
        let page = shown.get("/report");
        shown.save("fall.mbd", &fall("1.62"));
        shown.after(3);
        assert_ne!(shown.get("/report"), page);
    }

    #[test]
    fn only_this_machine_is_answered() {
        let shown = ShownPage::default();
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
